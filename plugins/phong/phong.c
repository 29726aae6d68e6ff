/*
 * phong: plastics and varnish, written in C from the header alone
 *
 *     void brdfplugin varnish
 *     2 phong phong
 *     0
 *     7 .4 .3 .2  .2 .2 .2  80
 *
 * | model   | arguments                                          | unit | range      |
 * |---------|----------------------------------------------------|------|------------|
 * | `phong` | rho_d, diffuse reflectance: red green blue         | 1    | 0 ... 1    |
 * |         | rho_s, strength of the highlight: red green blue   | 1    | 0 ... 1    |
 * |         | exponent n: the highlight is half as bright at     | 1    | 1 ... 1e6  |
 * |         | acos(0.5^(1/n)) from the mirror direction          |      |            |
 *
 * In each band rho_d + rho_s may not exceed 1.
 *
 * Lafortune and Willems, "Using the Modified Phong Reflectance Model for Physically Based Rendering", report CW 197, KU Leuven,
 * 1994: f = rho_d/pi + rho_s (n + 2)/(2 pi) cos^n(alpha), with alpha the angle from the mirror direction to the other direction.
 * It is reciprocal and conserves energy; towards grazing view the highlight darkens, as part of it falls below the horizon.
 *
 * Build:  cc -std=c11 -O2 -fPIC -shared -I. phong.c -o libphong.so -lm    (with radsight_brdf.h in this folder, see the Makefile)
 */
#include "radsight_brdf.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double PI = 3.14159265358979323846;

typedef struct Phong {
    uint32_t bands;
    double exponent;
    double highlight_share; /* probability of sampling the highlight */
    double rho[];           /* rho_d of each band, then rho_s of each */
} Phong;

enum { ROW_MATTE, ROW_HIGHLIGHT, ROW_EXPONENT };

static const RadsightBrdfParameter parameters[] = {
    {.name = "rho_d", .unit = "1", .doc = "matte reflectance", .kind = RADSIGHT_BRDF_SPECTRUM, .minimum = 0, .maximum = 1},
    {.name = "rho_s", .unit = "1", .doc = "strength of the highlight", .kind = RADSIGHT_BRDF_SPECTRUM, .minimum = 0, .maximum = 1},
    {.name = "exponent", .unit = "1", .doc = "sharpness of the highlight", .kind = RADSIGHT_BRDF_NUMBER, .minimum = 1, .maximum = 1e6},
};

static const RadsightBrdfModel model = {
    .struct_size = sizeof(RadsightBrdfModel),
    .flags = RADSIGHT_BRDF_DIFFUSE | RADSIGHT_BRDF_GLOSSY | RADSIGHT_BRDF_RECIPROCAL,
    .parameter_count = sizeof parameters / sizeof parameters[0],
    .parameter_size = sizeof parameters[0],
    .parameters = parameters,
    .name = "phong",
    .summary = "matte surface with a cosine-power highlight",
    .citation = "Lafortune and Willems, KU Leuven CW 197, 1994",
};

/* cos^n(alpha) with alpha from the mirror direction of `out` to `in`; 1 - |a-b|^2/2 is accurate for a small alpha. */
static double lobe(const Phong *self, const double out[3], double x, double y, double z) {
    const double dx = x + out[0], dy = y + out[1], dz = z - out[2];
    const double cosine = 1 - 0.5 * (dx * dx + dy * dy + dz * dz);
    return cosine > 0 ? pow(cosine, self->exponent) : 0;
}

static double density(const Phong *self, double power, double z) {
    const double highlight = (self->exponent + 1) / (2 * PI) * power;
    return self->highlight_share * highlight + (1 - self->highlight_share) * z / PI;
}

static double value(const Phong *self, uint32_t band, double power) {
    return self->rho[band] / PI + self->rho[self->bands + band] * (self->exponent + 2) / (2 * PI) * power;
}

static RadsightBrdfStatus eval_pdf(const void *data, const RadsightBrdfEval *call) {
    const Phong *self = data;
    for (uint32_t i = 0; i < call->count; i++) {
        const double z = call->incident_z[i];
        const int lit = z > 0 && call->outgoing[2] > 0;
        const double power = lit ? lobe(self, call->outgoing, call->incident_x[i], call->incident_y[i], z) : 0;
        call->pdfs[i] = lit ? density(self, power, z) : 0;
        for (uint32_t band = 0; band < self->bands; band++)
            call->values[(size_t)band * call->count + i] = lit ? value(self, band, power) : 0;
    }
    return RADSIGHT_BRDF_OK;
}

/* The unit vector at the angle with this cosine and sine from `axis`, at `azimuth` about it. */
static void direction_near(const double axis[3], double cosine, double sine, double azimuth, double found[3]) {
    /* Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017; axis[2] > 0 here. */
    const double a = -1 / (1 + axis[2]), b = axis[0] * axis[1] * a;
    const double x[3] = {1 + axis[0] * axis[0] * a, b, -axis[0]}, y[3] = {b, 1 + axis[1] * axis[1] * a, -axis[1]};
    for (int k = 0; k < 3; k++)
        found[k] = sine * (cos(azimuth) * x[k] + sin(azimuth) * y[k]) + cosine * axis[k];
}

static RadsightBrdfStatus sample(const void *data, const RadsightBrdfSample *call) {
    const Phong *self = data;
    const double *out = call->outgoing;
    for (uint32_t i = 0; i < call->count; i++) {
        double in[3] = {0, 0, 0};
        call->kinds[i] = RADSIGHT_BRDF_ABSORBED;
        if (out[2] <= 0) continue;
        if (call->u2[i] < self->highlight_share) {
            const double mirror[3] = {-out[0], -out[1], out[2]};
            /* 1 - cos(alpha) = -expm1(ln(1 - u)/(n + 1)), exact for a narrow highlight. */
            const double fall = -expm1(log1p(-call->u0[i]) / (self->exponent + 1));
            direction_near(mirror, 1 - fall, sqrt(fall * (2 - fall)), 2 * PI * call->u1[i], in);
        } else {
            const double radius = sqrt(call->u0[i]);
            in[0] = radius * cos(2 * PI * call->u1[i]);
            in[1] = radius * sin(2 * PI * call->u1[i]);
            in[2] = sqrt(1 - call->u0[i]);
        }
        if (in[2] <= 0) continue;
        const double power = lobe(self, out, in[0], in[1], in[2]);
        const double pdf = density(self, power, in[2]);
        if (pdf <= 0) continue;
        call->kinds[i] = RADSIGHT_BRDF_CONTINUOUS;
        call->incident_x[i] = in[0];
        call->incident_y[i] = in[1];
        call->incident_z[i] = in[2];
        call->pdfs[i] = pdf;
        for (uint32_t band = 0; band < self->bands; band++)
            call->weights[(size_t)band * call->count + i] = value(self, band, power) * in[2] / pdf;
    }
    return RADSIGHT_BRDF_OK;
}

static void destroy(void *data) { free(data); }

static uint32_t count(void) { return 1; }

static const RadsightBrdfModel *describe(uint32_t index) { return index == 0 ? &model : NULL; }

static RadsightBrdfStatus create(uint32_t index, const RadsightBrdfCreate *call, RadsightBrdfInstance *instance) {
    const uint32_t bands = call->band_count;
    if (index != 0 || call->number_count != 2 * bands + 1) return RADSIGHT_BRDF_BAD_ARGUMENT;
    double matte = 0, highlight = 0;
    for (uint32_t band = 0; band < bands; band++) {
        const double sum = call->numbers[band] + call->numbers[bands + band];
        if (!(sum <= 1 + 1e-9)) {
            call->error->parameter = ROW_HIGHLIGHT;
            snprintf(call->error->message, sizeof call->error->message, "rho_d + rho_s is %g, expected at most 1", sum);
            return RADSIGHT_BRDF_BAD_PARAMETER;
        }
        matte += call->numbers[band];
        highlight += call->numbers[bands + band];
    }
    Phong *self = malloc(sizeof *self + 2 * (size_t)bands * sizeof(double));
    if (!self) return RADSIGHT_BRDF_OUT_OF_MEMORY;
    self->bands = bands;
    self->exponent = call->numbers[2 * bands];
    self->highlight_share = highlight > 0 ? fmax(0.1, fmin(highlight / (matte + highlight), 0.9)) : 0;
    for (uint32_t k = 0; k < 2 * bands; k++) self->rho[k] = call->numbers[k];
    instance->data = self;
    instance->eval_pdf = eval_pdf;
    instance->sample = sample;
    instance->destroy = destroy;
    return RADSIGHT_BRDF_OK;
}

RADSIGHT_BRDF_EXPORT const RadsightBrdfEntry radsight_brdf_entry = {
    .magic = RADSIGHT_BRDF_MAGIC,
    .abi_major = RADSIGHT_BRDF_ABI_MAJOR,
    .abi_minor = RADSIGHT_BRDF_ABI_MINOR,
    .struct_size = sizeof(RadsightBrdfEntry),
    .count = count,
    .describe = describe,
    .create = create,
};
