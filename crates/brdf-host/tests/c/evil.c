/*
 * A Lambert that does evil where the variable EVIL says: "FUNCTION-DEED", such as "eval-segfault".
 * Functions: load, count, describe, create, eval, sample, destroy, end. EVIL_AFTER lets so many calls pass.
 */
#define _GNU_SOURCE
#include "radsight_brdf.h"
#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

static const double PI = 3.14159265358979323846;
static volatile int sink;
static int *volatile nowhere = (int *)16;
static volatile int zero;
static long calls;

static void spin(void) {
    for (;;) sink++;
}

static void sleep_for_ever(void) {
    for (;;) sleep(1000);
}

static int overflow(int depth) {
    volatile char frame[4096];
    frame[0] = (char)depth;
    return depth < 0 ? 0 : overflow(depth + 1) + frame[0];
}

/* Writes to what it takes, so that it really takes it. */
static void take_all_memory(void) {
    for (;;) {
        const size_t bytes = 1 << 22;
        memset(malloc(bytes), 1, bytes);
    }
}

/* A process that outlives its parent, in a session of its own, with all descriptors open. */
static void leave_an_orphan(void) {
    static int left;
    if (__atomic_exchange_n(&left, 1, __ATOMIC_RELAXED)) return;
    if (vfork() == 0) {
        execl("/bin/sh", "sh", "-c", "setsid sleep 1234 & setsid setsid sh -c 'sleep 1235' & exit 0", (char *)NULL);
        _exit(1);
    }
}

static void ignore(int number) { (void)number; }

static void replace_handlers(void) {
    const int numbers[] = {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) signal(numbers[i], ignore);
}

static void *crash_in_thread(void *nothing) {
    (void)nothing;
    *nowhere = 1;
    return NULL;
}

static void start_a_thread(void) {
    pthread_t thread;
    pthread_create(&thread, NULL, crash_in_thread, NULL);
    sleep_for_ever();
}

static void bus_error(void) {
    FILE *file = tmpfile();
    volatile char *empty = mmap(NULL, 4096, PROT_READ | PROT_WRITE, MAP_SHARED, fileno(file), 0);
    empty[0] = 1;
}

static void print(void) {
    printf("evil words by printf\n");
    fflush(stdout);
    const char words[] = "evil words by write\n";
    if (write(1, words, sizeof words - 1) < 0) abort();
    puts("evil words that stay in the buffer");
}

static void end_well(void) { _exit(0); }

static void do_deed(const char *deed) {
    if (!strcmp(deed, "segfault")) *nowhere = 1;
    else if (!strcmp(deed, "divide")) sink = 1 / zero, raise(SIGFPE); /* some machines give zero */
    else if (!strcmp(deed, "illegal")) __builtin_trap();
    else if (!strcmp(deed, "bus")) bus_error();
    else if (!strcmp(deed, "abort")) abort();
    else if (!strcmp(deed, "exit")) exit(0);
    else if (!strcmp(deed, "_exit")) _exit(0);
    else if (!strcmp(deed, "raw_exit")) syscall(SYS_exit_group, 0);
    else if (!strcmp(deed, "quick_exit")) quick_exit(0);
    else if (!strcmp(deed, "thread_exit")) pthread_exit(NULL);
    else if (!strcmp(deed, "overflow")) sink = overflow(0);
    else if (!strcmp(deed, "spin")) spin();
    else if (!strcmp(deed, "sleep")) sleep_for_ever();
    else if (!strcmp(deed, "hog")) take_all_memory();
    else if (!strcmp(deed, "print")) print();
    else if (!strcmp(deed, "fork")) sink = fork();
    else if (!strcmp(deed, "orphan")) leave_an_orphan();
    else if (!strcmp(deed, "orphan_and_sleep")) leave_an_orphan(), sleep_for_ever();
    else if (!strcmp(deed, "orphan_and_exit")) leave_an_orphan(), _exit(0);
    else if (!strcmp(deed, "at_exit")) atexit(end_well);
    else if (!strcmp(deed, "handlers")) replace_handlers();
    else if (!strcmp(deed, "handlers_and_segfault")) replace_handlers(), *nowhere = 1;
    else if (!strcmp(deed, "thread")) start_a_thread();
    else if (!strcmp(deed, "kill")) raise(SIGKILL);
    else if (!strcmp(deed, "terminate")) raise(SIGTERM);
    else if (!strcmp(deed, "stop")) raise(SIGSTOP);
    else if (!strcmp(deed, "close")) for (int i = 0; i < 256; i++) close(i);
    else if (!strncmp(deed, "close_fd", 8)) close(atoi(deed + 8));
    else if (!strcmp(deed, "close_and_exit")) { for (int i = 0; i < 256; i++) close(i); _exit(0); }
    else if (!strcmp(deed, "kill_parent")) kill(getppid(), SIGKILL), sleep_for_ever();
}

static void evil(const char *function) {
    const char *asked = getenv("EVIL"), *after = getenv("EVIL_AFTER");
    const size_t length = strlen(function);
    if (!asked || strncmp(asked, function, length) || asked[length] != '-') return;
    if (__atomic_fetch_add(&calls, 1, __ATOMIC_RELAXED) < (after ? atol(after) : 0)) return;
    do_deed(asked + length + 1);
}

__attribute__((constructor)) static void load(void) { evil("load"); }

__attribute__((destructor)) static void end(void) { evil("end"); }

typedef struct Lambert {
    uint32_t bands;
    double reflectance[];
} Lambert;

static RadsightBrdfStatus eval_pdf(const void *data, const RadsightBrdfEval *call) {
    const Lambert *self = data;
    evil("eval");
    for (uint32_t i = 0; i < call->count; i++) {
        const int lit = call->incident_z[i] > 0 && call->outgoing[2] > 0;
        call->pdfs[i] = lit ? call->incident_z[i] / PI : 0;
        for (uint32_t band = 0; band < self->bands; band++)
            call->values[(size_t)band * call->count + i] = lit ? self->reflectance[band] / PI : 0;
    }
    return RADSIGHT_BRDF_OK;
}

static RadsightBrdfStatus sample(const void *data, const RadsightBrdfSample *call) {
    const Lambert *self = data;
    evil("sample");
    for (uint32_t i = 0; i < call->count; i++) {
        const double azimuth = 2 * PI * call->u1[i], z = sqrt(1 - call->u0[i]), r = sqrt(1 - z * z);
        call->kinds[i] = call->outgoing[2] > 0 && z > 0 ? RADSIGHT_BRDF_CONTINUOUS : RADSIGHT_BRDF_ABSORBED;
        call->incident_x[i] = r * cos(azimuth);
        call->incident_y[i] = r * sin(azimuth);
        call->incident_z[i] = z;
        call->pdfs[i] = z / PI;
        for (uint32_t band = 0; band < self->bands; band++)
            call->weights[(size_t)band * call->count + i] = self->reflectance[band];
    }
    return RADSIGHT_BRDF_OK;
}

static void destroy(void *data) {
    evil("destroy");
    free(data);
}

static const RadsightBrdfParameter parameters[] = {
    {.name = "reflectance", .unit = "1", .doc = "share of light that is reflected", .kind = RADSIGHT_BRDF_SPECTRUM,
     .minimum = 0, .maximum = 1},
};

static const RadsightBrdfModel model = {
    .struct_size = sizeof(RadsightBrdfModel),
    .flags = RADSIGHT_BRDF_DIFFUSE | RADSIGHT_BRDF_RECIPROCAL,
    .parameter_count = 1,
    .parameter_size = sizeof parameters[0],
    .parameters = parameters,
    .name = "lambert",
    .summary = "ideal diffuse reflection, or worse",
};

static uint32_t count(void) {
    evil("count");
    return 1;
}

static const RadsightBrdfModel *describe(uint32_t index) {
    evil("describe");
    return index == 0 ? &model : NULL;
}

static RadsightBrdfStatus create(uint32_t index, const RadsightBrdfCreate *call, RadsightBrdfInstance *instance) {
    evil("create");
    if (index != 0 || call->number_count != call->band_count) return RADSIGHT_BRDF_BAD_ARGUMENT;
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

RADSIGHT_BRDF_EXPORT const RadsightBrdfEntry radsight_brdf_entry = {
    .magic = RADSIGHT_BRDF_MAGIC,
    .abi_major = RADSIGHT_BRDF_ABI_MAJOR,
    .abi_minor = RADSIGHT_BRDF_ABI_MINOR,
    .struct_size = sizeof(RadsightBrdfEntry),
    .count = count,
    .describe = describe,
    .create = create,
};
