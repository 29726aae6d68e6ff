/*
 * radsight_brdf.h: the interface between radsight and a BRDF plugin, ABI 1.1.
 *
 * A plugin is a shared library that exports one constant:
 *
 *     RADSIGHT_BRDF_EXPORT const RadsightBrdfEntry radsight_brdf_entry = { ... };
 *
 * It may contain any number of models. This header is all that is needed to write one:
 *
 *     cc -std=c11 -O2 -fPIC -shared -I. my_brdf.c -o libmy_brdf.so
 *     radsight plugin check ./libmy_brdf.so
 *
 * MEANING
 *   Frame       All directions are in the local frame of one surface point: +z is the shading normal, x and y complete a
 *               right-handed orthonormal frame. The azimuth of x has a meaning only for a model that sets
 *               RADSIGHT_BRDF_ANISOTROPIC; any other model must not depend on it.
 *   Directions  Unit vectors that point AWAY from the surface. `outgoing` is where the light goes (towards the eye or the
 *               camera), `incident` is where the light comes from. z > 0 is the front, z < 0 the back. A host may pass any
 *               direction, even with z <= 0 or grazing: return zero where the model does not reflect. Lengths are 1 to rounding.
 *   Value       The BRDF f in 1/sr: outgoing radiance per incident irradiance. It does NOT contain the cosine.
 *   pdf         The density of the incident direction in `sample`, per solid angle (1/sr), summed over all lobes of finite width.
 *               It may integrate to less than 1: the rest is absorbed, or sampled from delta lobes.
 *   Weight      f * |cos(theta_i)| / pdf, where theta_i is the angle from the normal to the incident direction. For a delta lobe:
 *               its reflectance divided by the probability with which it was chosen.
 *   Bands       A model works in `band_count` spectral bands; `create` gets their wavelengths. Arrays "by band" hold all
 *               directions of band 0, then all directions of band 1, ...: element [band * count + direction].
 *   Units       SI: metres, radians, steradians. Parameters have the unit that the parameter table gives.
 *
 * THREADS
 *   [one thread]  never called while another function of the same library that is marked so runs.
 *   [any thread]  called from many threads at once, even for the same instance: it must not modify shared data.
 *
 * POINTERS
 *   Everything that the host passes to a function belongs to the host and is valid until that function returns, but for
 *   `RadsightBrdfHost`, which is valid as long as the library is loaded. Everything that the entry and the descriptors point to
 *   belongs to the plugin and must stay valid and unchanged as long as the library is loaded. A library is never unloaded
 *   before the program ends. Strings are UTF-8 and end with a zero byte. Arrays do not overlap.
 *
 * ERRORS
 *   Functions return a status. No C++ exception, longjmp or Rust panic may leave a function.
 *
 * CONDUCT
 *   A plugin does not end the process or its thread, fork, handle signals, or close, read or write standard input and output:
 *   it hands lines to `log`. What it prints goes to standard error. A host may end the program for a call that crashes, does
 *   not return or takes too much memory. It may run the library in a process of its own, and may end without calling the
 *   library's destructors.
 *
 * VERSIONS
 *   Host and plugin must have the same major version. A minor version only appends fields at the end of structures, functions
 *   at the end of the entry, and constants. Each structure begins with, or is accompanied by, its size in the version of the side
 *   that made it; the other side reads no field beyond that size. Reserved fields are zero.
 *     1.0  the core
 *     1.1  `extension` in RadsightBrdfEntry and in RadsightBrdfHost
 */
#ifndef RADSIGHT_BRDF_H
#define RADSIGHT_BRDF_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define RADSIGHT_BRDF_MAGIC UINT64_C(0x5241445342524446) /* "RADSBRDF" */
#define RADSIGHT_BRDF_ABI_MAJOR 1u
#define RADSIGHT_BRDF_ABI_MINOR 1u

#if defined(_WIN32)
#define RADSIGHT_BRDF_VISIBLE __declspec(dllexport)
#elif defined(__GNUC__)
#define RADSIGHT_BRDF_VISIBLE __attribute__((visibility("default")))
#else
#define RADSIGHT_BRDF_VISIBLE
#endif
#ifdef __cplusplus
#define RADSIGHT_BRDF_EXPORT extern "C" RADSIGHT_BRDF_VISIBLE
#else
#define RADSIGHT_BRDF_EXPORT RADSIGHT_BRDF_VISIBLE
#endif

/* Status: what a function returns. */
typedef uint32_t RadsightBrdfStatus;
#define RADSIGHT_BRDF_OK 0u
#define RADSIGHT_BRDF_BAD_ARGUMENT 1u  /* the host violated this header, such as a model index that does not exist */
#define RADSIGHT_BRDF_BAD_PARAMETER 2u /* a parameter is invalid; RadsightBrdfError gives its row and the reason */
#define RADSIGHT_BRDF_FILE_ERROR 3u    /* a file named by a parameter cannot be read or parsed */
#define RADSIGHT_BRDF_OUT_OF_MEMORY 4u
#define RADSIGHT_BRDF_UNSUPPORTED 5u   /* unsupported request, such as a number of bands */
#define RADSIGHT_BRDF_INTERNAL 6u      /* internal error that the plugin detected itself */
#define RADSIGHT_BRDF_PANIC 7u         /* a panic or exception, stopped at the interface */

/* Flags of a model or an instance: lobes in the low byte, declared properties in the next. */
#define RADSIGHT_BRDF_DIFFUSE 0x1u       /* smooth functions of direction, such as Lambert's */
#define RADSIGHT_BRDF_GLOSSY 0x2u        /* lobes of finite width */
#define RADSIGHT_BRDF_DELTA 0x4u         /* perfectly specular directions, which only `sample` finds */
#define RADSIGHT_BRDF_TRANSMISSION 0x8u  /* incident and outgoing may be on different sides */
#define RADSIGHT_BRDF_ANISOTROPIC 0x10u  /* depends on the azimuth of the frame's x axis */
#define RADSIGHT_BRDF_RECIPROCAL 0x100u  /* declares that f(outgoing, incident) = f(incident, outgoing); the host checks it */

/* Kinds of parameters. Words and numbers are separate lists in a scene, each in the order of the table. */
#define RADSIGHT_BRDF_NUMBER 0u  /* one number */
#define RADSIGHT_BRDF_INTEGER 1u /* one number without a fraction */
#define RADSIGHT_BRDF_SPECTRUM 2u /* three numbers in a scene (red green blue); `create` gets one number for each band */
#define RADSIGHT_BRDF_WORD 3u    /* one word */
#define RADSIGHT_BRDF_CHOICE 4u  /* one word out of `choices` */
#define RADSIGHT_BRDF_FILE 5u    /* one word that names a file; the host makes it relative to the scene's folder if it is there */

/* Flags of a parameter. */
#define RADSIGHT_BRDF_OPTIONAL 0x1u          /* may be omitted with all later ones of its list; the default is then used */
#define RADSIGHT_BRDF_ABOVE_MINIMUM 0x2u     /* the minimum itself is not allowed */
#define RADSIGHT_BRDF_BELOW_MAXIMUM 0x4u     /* the maximum itself is not allowed */

/* One row of a parameter table. */
typedef struct RadsightBrdfParameter {
    const char *name;         /* for messages and tables, such as "roughness" */
    const char *unit;         /* such as "rad" or "1" */
    const char *doc;          /* one sentence */
    uint32_t kind;            /* RADSIGHT_BRDF_NUMBER ... */
    uint32_t flags;           /* RADSIGHT_BRDF_OPTIONAL ... */
    double default_number;    /* of an optional number; of a spectrum, in each band */
    double minimum;           /* smallest allowed number; -INFINITY when there is none */
    double maximum;           /* largest allowed number; INFINITY when there is none */
    const char *default_word; /* of an optional word; may be NULL for others */
    const char *choices;      /* of a choice: the words, separated by '|'; NULL for others */
} RadsightBrdfParameter;

/* Description of a model. */
typedef struct RadsightBrdfModel {
    uint32_t struct_size;     /* sizeof(RadsightBrdfModel) */
    uint32_t flags;           /* possible lobes of an instance, and declared properties */
    uint32_t parameter_count;
    uint32_t parameter_size;  /* sizeof(RadsightBrdfParameter): the distance from one row to the next */
    const RadsightBrdfParameter *parameters; /* NULL when there is none */
    const char *name;         /* name in a scene: letters, digits, '_' and '-' */
    const char *summary;      /* one line */
    const char *citation;     /* source of the formulas; may be NULL */
} RadsightBrdfModel;

/* A spectral band. */
typedef struct RadsightBrdfBand {
    double centre_m;          /* wavelength, metres */
    double low_m;             /* lower limit, metres; at most centre_m */
    double high_m;            /* upper limit, metres; at least centre_m */
} RadsightBrdfBand;

/* Why `create` failed. The host makes it, the plugin may fill it in. */
typedef struct RadsightBrdfError {
    uint32_t struct_size;     /* sizeof(RadsightBrdfError), set by the host */
    int32_t parameter;        /* row of the parameter table, or -1; the host sets -1 */
    char message[240];        /* ends with a zero byte; lower case, no full stop */
} RadsightBrdfError;

/* Services of the host. Valid as long as the library is loaded. */
typedef struct RadsightBrdfHost RadsightBrdfHost;
struct RadsightBrdfHost {
    uint32_t struct_size;     /* sizeof(RadsightBrdfHost) of the host */
    uint32_t abi_major;
    uint32_t abi_minor;
    uint32_t reserved;
    /* [any thread] Logs a line of text. level: 0 note, 1 warning, 2 error. The text is copied. */
    void (*log)(const RadsightBrdfHost *host, uint32_t level, const char *text);
    /* since 1.1. [any thread] The host's function table of this name and revision, or NULL. Owned by the host. */
    const void *(*extension)(const RadsightBrdfHost *host, const char *name, uint32_t revision);
};

/* Arguments of `create`. */
typedef struct RadsightBrdfCreate {
    uint32_t struct_size;     /* sizeof(RadsightBrdfCreate) of the host */
    uint32_t band_count;      /* at least 1 */
    const RadsightBrdfBand *bands; /* band_count */
    const double *numbers;    /* for each NUMBER, INTEGER or SPECTRUM row in order: 1 number, or band_count for a spectrum */
    const char *const *words; /* for each WORD, CHOICE or FILE row in order: 1 word */
    uint32_t number_count;    /* as many as the table requires: defaults are filled in */
    uint32_t word_count;
    const RadsightBrdfHost *host; /* the plugin may keep the pointer */
    RadsightBrdfError *error;
} RadsightBrdfCreate;

/* A call of `eval_pdf`: one outgoing direction, a batch of incident ones. */
typedef struct RadsightBrdfEval {
    uint32_t struct_size;     /* sizeof(RadsightBrdfEval) of the host */
    uint32_t count;           /* of incident directions; may be 0 */
    double outgoing[3];
    const double *incident_x; /* count each */
    const double *incident_y;
    const double *incident_z;
    double *values;           /* out, by band: f in 1/sr, band_count * count. Every element must be written. */
    double *pdfs;             /* out: 1/sr, count. Every element must be written. */
    void *scratch;            /* of the size that the instance requested, aligned to 64 bytes, content undefined */
} RadsightBrdfEval;

/* Kinds of results of `sample`. */
#define RADSIGHT_BRDF_ABSORBED 0u   /* absorption; direction, weights and pdf are ignored */
#define RADSIGHT_BRDF_CONTINUOUS 1u /* a direction with the density `pdfs` */
#define RADSIGHT_BRDF_DELTA_HIT 2u  /* a perfectly specular direction; its pdf is ignored */

/* A call of `sample`: one outgoing direction, a batch of points in the unit cube. */
typedef struct RadsightBrdfSample {
    uint32_t struct_size;     /* sizeof(RadsightBrdfSample) of the host */
    uint32_t count;           /* of points; may be 0 */
    double outgoing[3];
    const double *u0;         /* count each, in [0,1): u0 and u1 choose the direction, u2 the lobe */
    const double *u1;
    const double *u2;
    double *incident_x;       /* out, count each: unit vectors */
    double *incident_y;
    double *incident_z;
    double *weights;          /* out, by band: band_count * count, dimensionless */
    double *pdfs;             /* out: 1/sr, count */
    uint8_t *kinds;           /* out: RADSIGHT_BRDF_ABSORBED ..., count */
    void *scratch;            /* as in RadsightBrdfEval */
} RadsightBrdfSample;

/* A model with its parameters. The host makes and owns the structure, `create` fills it in. */
typedef struct RadsightBrdfInstance {
    uint32_t struct_size;     /* sizeof(RadsightBrdfInstance) of the host; write no field beyond it */
    uint32_t flags;           /* lobes of this instance; declared properties are those of the model */
    uint64_t scratch_bytes;   /* scratch of a call: this much ... */
    uint64_t scratch_bytes_per_direction; /* ... and this much for each element of its batch */
    void *data;               /* private data of the plugin, passed back to it */
    /* [any thread] */
    RadsightBrdfStatus (*eval_pdf)(const void *data, const RadsightBrdfEval *call);
    /* [any thread] */
    RadsightBrdfStatus (*sample)(const void *data, const RadsightBrdfSample *call);
    /* [one thread] Frees `data`; called once, after all calls with it have returned. May be NULL. */
    void (*destroy)(void *data);
} RadsightBrdfInstance;

/* The exported constant radsight_brdf_entry. */
typedef struct RadsightBrdfEntry {
    uint64_t magic;           /* RADSIGHT_BRDF_MAGIC */
    uint32_t abi_major;       /* RADSIGHT_BRDF_ABI_MAJOR */
    uint32_t abi_minor;       /* RADSIGHT_BRDF_ABI_MINOR */
    uint32_t struct_size;     /* sizeof(RadsightBrdfEntry) */
    uint32_t reserved;        /* 0 */
    /* [one thread] Number of models; constant. */
    uint32_t (*count)(void);
    /* [one thread] Description of the model with this index, or NULL; constant. */
    const RadsightBrdfModel *(*describe)(uint32_t index);
    /* [one thread] Makes an instance. After any status but OK there is none, and `destroy` is not called. Parameters are within
       their ranges, but may contradict each other. `create` checks number_count, word_count and band_count before it reads them:
       `plugin check` also calls it with wrong ones. Wrong counts, and an index that does not exist, give
       RADSIGHT_BRDF_BAD_ARGUMENT. */
    RadsightBrdfStatus (*create)(uint32_t index, const RadsightBrdfCreate *call, RadsightBrdfInstance *instance);
    /* since 1.1. [any thread] The library's function table or text of this name and revision, or NULL.
       May itself be NULL. Known to this host: "radsight.manual" revision 1, a const char * with the manual page of the library. */
    const void *(*extension)(const char *name, uint32_t revision);
} RadsightBrdfEntry;

#ifdef __cplusplus
}
#endif
#endif
