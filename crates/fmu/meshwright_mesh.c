/* The mesh of a gear pair as an FMU 2.0, for Model Exchange and Co-Simulation. It has no state: torques follow from angles by the table in
 * resources/table.bin (doubles, little-endian, so that no locale reads them otherwise), which is the force table of one job; this file is the
 * same for all. MIT licence. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

/* Names as FMI 2.0 has them: whoever links several sources into one program defines a prefix for each. */
#ifdef FMI2_FUNCTION_PREFIX
#define PASTE(a, b) a##b
#define JOIN(a, b) PASTE(a, b)
#define NAMED(name) JOIN(FMI2_FUNCTION_PREFIX, fmi2##name)
#else
#define NAMED(name) fmi2##name
#endif

typedef enum { ok, warning, discard, error, fatal, pending } Status;
typedef unsigned int Reference;
enum { THETA_1, THETA_2, TORQUE_1, TORQUE_2, TRANSMISSION_ERROR, REALS };

/* The table: `rows` loads at `positions` places over `period` rad of the driving gear; approaches of the loaded and of the other flank. */
typedef struct {
    int positions, rows;
    double period, radius_1, radius_2, *loads, *flanks[2], input[2];
} Mesh;

/* Reads the table under a file URI or a path. */
static int read_table(Mesh *mesh, const char *location) {
    char path[4096];
    size_t n = 0;
    if (strncmp(location, "file:", 5) == 0) location += 5;
    if (strncmp(location, "//", 2) == 0) location = strchr(location + 2, '/');
#ifdef _WIN32
    if (location && location[0] == '/' && location[1] && location[2] == ':') location++;
#endif
    while (location && *location && n < sizeof path - 16) {
        unsigned int code;
        if (*location == '%' && sscanf(location + 1, "%2x", &code) == 1) path[n++] = (char)code, location += 3;
        else path[n++] = *location++;
    }
    strcpy(path + n, "/table.bin");
    FILE *file = fopen(path, "rb");
    if (!file) return 0;
    double head[5];
    int good = fread(head, sizeof(double), 5, file) == 5 && head[0] > 1 && head[0] < 1e6 && head[1] > 1 && head[1] < 1e4;
    if (good) {
        size_t rows = (size_t)head[1], each = rows * (size_t)head[0], all = rows + 2 * each;
        mesh->positions = (int)head[0], mesh->rows = (int)rows;
        mesh->period = head[2], mesh->radius_1 = head[3], mesh->radius_2 = head[4];
        good = (mesh->loads = malloc(all * sizeof(double))) != NULL && fread(mesh->loads, sizeof(double), all, file) == all;
        mesh->flanks[0] = mesh->loads + rows, mesh->flanks[1] = mesh->flanks[0] + each;
    }
    fclose(file);
    return good;
}

/* F and dV/dtheta_1 at an angle and an approach: straight lines in angle and load, as they stand in the table. */
static double load_at(const Mesh *mesh, double theta, double delta, double *per_angle) {
    double step = mesh->period / mesh->positions;
    double place = (theta - mesh->period * floor(theta / mesh->period)) / step;
    int first = (int)place < mesh->positions ? (int)place : mesh->positions - 1, second = (first + 1) % mesh->positions;
    double part = place - first;
    *per_angle = 0;
    for (int flank = 0; flank < 2; flank++) {
        double sign = flank ? -1 : 1;
        const double *row = mesh->flanks[flank];
#define AT(j) (row[(j) * mesh->positions + first] + part * (row[(j) * mesh->positions + second] - row[(j) * mesh->positions + first]))
#define SLOPE(j) ((row[(j) * mesh->positions + second] - row[(j) * mesh->positions + first]) / step)
        if (sign * (delta - AT(0)) <= 0) continue;
        int j = 0;
        for (; j + 2 < mesh->rows && sign * (delta - AT(j + 1)) >= 0; j++)
            *per_angle -= sign * (SLOPE(j) + SLOPE(j + 1)) / 2 * (mesh->loads[j + 1] - mesh->loads[j]);
        double beyond = (delta - AT(j)) / (AT(j + 1) - AT(j)), load = beyond * (mesh->loads[j + 1] - mesh->loads[j]);
        *per_angle -= sign * (SLOPE(j) + beyond * (SLOPE(j + 1) - SLOPE(j)) / 2) * load;
        return sign * (mesh->loads[j] + load);
    }
    return 0;
}

EXPORT void *NAMED(Instantiate)(const char *name, int type, const char *guid, const char *resources, const void *callbacks, int visible, int logging) {
    (void)name, (void)type, (void)guid, (void)callbacks, (void)visible, (void)logging;
    Mesh *mesh = calloc(1, sizeof *mesh);
    if (mesh && resources && read_table(mesh, resources)) return mesh;
    if (mesh) free(mesh->loads);
    free(mesh);
    return NULL;
}
EXPORT void NAMED(FreeInstance)(void *c) {
    if (c) free(((Mesh *)c)->loads);
    free(c);
}
EXPORT Status NAMED(GetReal)(void *c, const Reference of[], size_t count, double value[]) {
    Mesh *mesh = c;
    double per_angle, delta = mesh->radius_1 * mesh->input[THETA_1] - mesh->radius_2 * mesh->input[THETA_2];
    double load = load_at(mesh, mesh->input[THETA_1], delta, &per_angle);
    double reals[REALS] = { mesh->input[0], mesh->input[1], -mesh->radius_1 * load - per_angle, mesh->radius_2 * load, 1e6 * delta };
    for (size_t i = 0; i < count; i++) {
        if (of[i] >= REALS) return error;
        value[i] = reals[of[i]];
    }
    return ok;
}
EXPORT Status NAMED(SetReal)(void *c, const Reference of[], size_t count, const double value[]) {
    for (size_t i = 0; i < count; i++) {
        if (of[i] > THETA_2) return error;
        ((Mesh *)c)->input[of[i]] = value[i];
    }
    return ok;
}
EXPORT Status NAMED(Reset)(void *c) {
    memset(((Mesh *)c)->input, 0, sizeof ((Mesh *)c)->input);
    return ok;
}
typedef struct { int again, terminate, nominals, values, defined; double next; } EventInfo;
EXPORT Status NAMED(NewDiscreteStates)(void *c, EventInfo *info) {
    (void)c;
    memset(info, 0, sizeof *info);
    return ok;
}
EXPORT Status NAMED(CompletedIntegratorStep)(void *c, int keep, int *event, int *terminate) {
    (void)c, (void)keep;
    *event = *terminate = 0;
    return ok;
}
EXPORT const char *NAMED(GetTypesPlatform)(void) { return "default"; }
EXPORT const char *NAMED(GetVersion)(void) { return "2.0"; }

/* What a model without states, events and further variables has nothing to do for. */
#define NOTHING(name, ...) EXPORT Status NAMED(name)(__VA_ARGS__) { return ok; }
#define NEVER(name, ...) EXPORT Status NAMED(name)(__VA_ARGS__) { return error; }
#pragma GCC diagnostic ignored "-Wunused-parameter"
NOTHING(SetDebugLogging, void *c, int on, size_t n, const char *const categories[])
NOTHING(SetupExperiment, void *c, int defined, double tolerance, double start, int ends, double stop)
NOTHING(EnterInitializationMode, void *c)
NOTHING(ExitInitializationMode, void *c)
NOTHING(EnterEventMode, void *c)
NOTHING(EnterContinuousTimeMode, void *c)
NOTHING(Terminate, void *c)
NOTHING(SetTime, void *c, double time)
NOTHING(DoStep, void *c, double time, double step, int keep)
NOTHING(CancelStep, void *c)
NOTHING(SetContinuousStates, void *c, const double x[], size_t n)
NOTHING(GetDerivatives, void *c, double dx[], size_t n)
NOTHING(GetEventIndicators, void *c, double z[], size_t n)
NOTHING(GetContinuousStates, void *c, double x[], size_t n)
NOTHING(GetNominalsOfContinuousStates, void *c, double x[], size_t n)
NEVER(GetInteger, void *c, const Reference of[], size_t n, int value[])
NEVER(GetBoolean, void *c, const Reference of[], size_t n, int value[])
NEVER(GetString, void *c, const Reference of[], size_t n, const char *value[])
NEVER(SetInteger, void *c, const Reference of[], size_t n, const int value[])
NEVER(SetBoolean, void *c, const Reference of[], size_t n, const int value[])
NEVER(SetString, void *c, const Reference of[], size_t n, const char *const value[])
NEVER(GetFMUstate, void *c, void **state)
NEVER(SetFMUstate, void *c, void *state)
NEVER(FreeFMUstate, void *c, void **state)
NEVER(SerializedFMUstateSize, void *c, void *state, size_t *size)
NEVER(SerializeFMUstate, void *c, void *state, char bytes[], size_t size)
NEVER(DeSerializeFMUstate, void *c, const char bytes[], size_t size, void **state)
NEVER(GetDirectionalDerivative, void *c, const Reference of[], size_t n, const Reference by[], size_t m, const double seed[], double value[])
NEVER(SetRealInputDerivatives, void *c, const Reference of[], size_t n, const int order[], const double value[])
NEVER(GetRealOutputDerivatives, void *c, const Reference of[], size_t n, const int order[], double value[])
NEVER(GetStatus, void *c, int kind, Status *value)
NEVER(GetRealStatus, void *c, int kind, double *value)
NEVER(GetIntegerStatus, void *c, int kind, int *value)
NEVER(GetBooleanStatus, void *c, int kind, int *value)
NEVER(GetStringStatus, void *c, int kind, const char **value)
