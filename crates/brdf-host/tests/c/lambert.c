/* An honest Lambert, and, by -DBROKEN_..., every way to be a bad plugin. */
#include "radsight_brdf.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

#if defined(BROKEN_MAJOR)
#undef RADSIGHT_BRDF_ABI_MAJOR
#define RADSIGHT_BRDF_ABI_MAJOR 7u
#endif
#if defined(MINOR)
#undef RADSIGHT_BRDF_ABI_MINOR
#define RADSIGHT_BRDF_ABI_MINOR MINOR
#endif

typedef struct Lambert {
    uint32_t bands;
    double reflectance[];
} Lambert;

static double value_of(const double out[3], const double in[3], double reflectance) {
    (void)out;
    (void)in;
#if defined(BROKEN_ENERGY)
    reflectance *= 1.3;
#elif defined(BROKEN_RECIPROCITY)
    reflectance *= 0.5 + 0.5 * in[2];
#elif defined(BROKEN_GRAZING)
    if (in[2] < 0.05) return NAN;
#elif defined(BROKEN_NEGATIVE)
    return -1.0;
#elif defined(BROKEN_INFINITE)
    return INFINITY;
#elif defined(BROKEN_ANISOTROPY)
    reflectance *= 0.75 + 0.25 * in[0] * out[0];
#endif
    return reflectance / PI;
}

static volatile int sink;
static int *volatile nowhere = (int *)16;
#if defined(BROKEN_STATE)
static volatile uint32_t calls;
#endif

static void misbehave(void) {
#if defined(BROKEN_SEGFAULT)
    *nowhere = 1;
#elif defined(BROKEN_ABORT)
    abort();
#elif defined(BROKEN_HANG)
    for (;;) sink++;
#endif
    sink = nowhere != NULL;
}

static RadsightBrdfStatus eval_pdf(const void *data, const RadsightBrdfEval *call) {
    const Lambert *self = data;
    misbehave();
#if defined(BROKEN_STATUS)
    return RADSIGHT_BRDF_INTERNAL;
#endif
    for (uint32_t i = 0; i < call->count; i++) {
        const double in[3] = {call->incident_x[i], call->incident_y[i], call->incident_z[i]};
        const int lit = in[2] > 0 && call->outgoing[2] > 0;
        call->pdfs[i] = lit ? in[2] / PI : 0;
        for (uint32_t band = 0; band < self->bands; band++) {
            double value = lit ? value_of(call->outgoing, in, self->reflectance[band]) : 0;
#if defined(BROKEN_STATE)
            value *= 1 + 1e-3 * (calls++ % 7);
#elif defined(BROKEN_BATCH)
            value *= 1 + 1e-3 * i;
#elif defined(BROKEN_UNWRITTEN)
            if (i == call->count - 1) continue;
#endif
            call->values[(size_t)band * call->count + i] = value;
        }
    }
    return RADSIGHT_BRDF_OK;
}

static RadsightBrdfStatus sample(const void *data, const RadsightBrdfSample *call) {
    const Lambert *self = data;
    for (uint32_t i = 0; i < call->count; i++) {
        const double azimuth = 2 * PI * call->u1[i];
#if defined(BROKEN_PDF)
        const double z = 1 - call->u0[i]; /* uniform, but the cosine's density is claimed */
#else
        const double z = sqrt(1 - call->u0[i]);
#endif
        const double r = sqrt(1 - z * z);
        const double in[3] = {r * cos(azimuth), r * sin(azimuth), z};
        const int lit = z > 0 && call->outgoing[2] > 0;
        call->kinds[i] = lit ? RADSIGHT_BRDF_CONTINUOUS : RADSIGHT_BRDF_ABSORBED;
#if defined(BROKEN_KIND)
        call->kinds[i] = 9;
#endif
        call->incident_x[i] = in[0];
        call->incident_y[i] = in[1];
        call->incident_z[i] = in[2];
#if defined(BROKEN_LENGTH)
        call->incident_x[i] *= 1.1;
#endif
        call->pdfs[i] = z / PI;
        for (uint32_t band = 0; band < self->bands; band++)
            call->weights[(size_t)band * call->count + i] = PI * value_of(call->outgoing, in, self->reflectance[band])
#if defined(BROKEN_WEIGHT)
                * 0.9
#endif
                ;
    }
    return RADSIGHT_BRDF_OK;
}

static void destroy(void *data) {
#if !defined(BROKEN_LEAK)
    free(data);
#else
    (void)data;
#endif
}

static const RadsightBrdfParameter parameters[] = {
    {.name = "reflectance", .unit = "1", .doc = "share of light that is reflected", .kind = RADSIGHT_BRDF_SPECTRUM,
     .minimum = 0, .maximum = 1},
};

static const RadsightBrdfModel model = {
    .struct_size = sizeof(RadsightBrdfModel),
    .flags = RADSIGHT_BRDF_DIFFUSE | RADSIGHT_BRDF_RECIPROCAL,
    .parameter_count = sizeof parameters / sizeof parameters[0],
    .parameter_size = sizeof parameters[0],
    .parameters = parameters,
    .name = "lambert",
    .summary = "ideal diffuse reflection",
    .citation = "Lambert, Photometria, 1760",
};

static uint32_t count(void) { return 1; }

static const RadsightBrdfModel *describe(uint32_t index) {
#if defined(BROKEN_DESCRIBE)
    (void)index;
    return NULL;
#endif
    return index == 0 ? &model : NULL;
}

static RadsightBrdfStatus create(uint32_t index, const RadsightBrdfCreate *call, RadsightBrdfInstance *instance) {
#if defined(BROKEN_ARGUMENTS)
    if (index > 100) *nowhere = 1;
#endif
    if (index != 0 || call->number_count != call->band_count) return RADSIGHT_BRDF_BAD_ARGUMENT;
    if (call->numbers[0] == 0.125) { /* so that a test can see a refusal */
        call->error->parameter = 0;
        strcpy(call->error->message, "one eighth is an unlucky number");
        return RADSIGHT_BRDF_BAD_PARAMETER;
    }
    Lambert *self = malloc(sizeof *self + call->band_count * sizeof(double));
    if (!self) return RADSIGHT_BRDF_OUT_OF_MEMORY;
    self->bands = call->band_count;
    memcpy(self->reflectance, call->numbers, call->band_count * sizeof(double));
    instance->data = self;
    instance->eval_pdf = eval_pdf;
    instance->sample = sample;
    instance->destroy = destroy;
    return RADSIGHT_BRDF_OK;
}

#if defined(BROKEN_SYMBOL)
#define radsight_brdf_entry some_other_name
#endif

#if defined(MINOR) && MINOR == 0
/* As the header was before `extension` was appended. */
typedef struct OldEntry {
    uint64_t magic;
    uint32_t abi_major, abi_minor, struct_size, reserved;
    uint32_t (*count)(void);
    const RadsightBrdfModel *(*describe)(uint32_t index);
    RadsightBrdfStatus (*create)(uint32_t index, const RadsightBrdfCreate *call, RadsightBrdfInstance *instance);
} Entry;
#elif defined(MINOR) && MINOR == 2
/* As a later header might be: more behind the end. */
typedef struct NewEntry {
    RadsightBrdfEntry today;
    void (*of_tomorrow)(double);
    uint64_t more[4];
} Entry;
#else
typedef RadsightBrdfEntry Entry;
#endif

RADSIGHT_BRDF_EXPORT const Entry radsight_brdf_entry = {
#if defined(MINOR) && MINOR == 2
    .today = {
#endif
#if defined(BROKEN_MAGIC)
    .magic = 42,
#else
    .magic = RADSIGHT_BRDF_MAGIC,
#endif
    .abi_major = RADSIGHT_BRDF_ABI_MAJOR,
    .abi_minor = RADSIGHT_BRDF_ABI_MINOR,
    .struct_size = sizeof(Entry),
    .count = count,
    .describe = describe,
    .create = create,
#if defined(MINOR) && MINOR == 2
    },
    .more = {~UINT64_C(0), 1, 2, 3},
#endif
};
