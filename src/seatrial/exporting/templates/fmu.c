{% for line in head %}
/* {{ line }} */
{% endfor %}
/* FMI 2.0 for co-simulation (Functional Mock-up Interface specification 2.0.4); types as in fmi2TypesPlatform.h. */
#include "{{ name }}.h"

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#if defined(_WIN32)
#define EXPORTED __declspec(dllexport)
#elif defined(__GNUC__)
#define EXPORTED __attribute__((visibility("default")))
#else
#define EXPORTED
#endif
#ifdef FMI2_FUNCTION_PREFIX
#define JOINED(a, b) a##b
#define PREFIXED(a, b) JOINED(a, b)
#define FMI(name) PREFIXED(FMI2_FUNCTION_PREFIX, name)
#else
#define FMI(name) name
#endif

typedef void *Component;
typedef unsigned int Reference;
typedef enum { OK, WARNING, DISCARD, ERROR, FATAL, PENDING } Status;
typedef struct {
    void (*log)(void *environment, const char *name, Status status, const char *category, const char *message, ...);
    void *(*allocate)(size_t count, size_t size);
    void (*release)(void *memory);
    void (*finished)(void *environment, Status status);
    void *environment;
} Callbacks;

#define NX {{ NAME }}_NX
#define NU {{ NAME }}_NU
#define NY {{ NAME }}_NY
#define NP {{ NAME }}_NP
enum { FIRST_INPUT = NX, FIRST_OUTPUT = FIRST_INPUT + NU, FIRST_PARAMETER = FIRST_OUTPUT + NY,
       MAX_STEP = FIRST_PARAMETER + NP, RANGE_USE };
typedef enum { INSTANTIATED, INITIALISING, STEPPING, FAILED, TERMINATED } Mode;

/* Everything that changes: what a saved state holds. */
typedef struct {
    {{ name }}_parameters p;
    double x[NX], u[NU + 1], slope[NU + 1], max_step;
    Mode mode;
} Data;

typedef struct {
    Data data;
    const Callbacks *callbacks;
    char name[128];
{% if is_affine %}
    {{ name }}_propagator m;
    double prepared; /* s, the step of m; 0: none */
{% endif %}
} Instance;

/* a struct of doubles without padding: parameter i is the i-th of them */
typedef char no_padding[sizeof({{ name }}_parameters) == (NP ? NP : 1) * sizeof(double) ? 1 : -1];

static const double start_x[NX] = { {{ start_x }} };
static const double start_u[NU + 1] = { {{ start_u }} };
static const double lower[NP + 1] = { {{ lower }} };
static const double upper[NP + 1] = { {{ upper }} };

static void set_start(Instance *c)
{
    memset(&c->data, 0, sizeof c->data);
    c->data.p = {{ name }}_identified;
    memcpy(c->data.x, start_x, sizeof start_x);
    memcpy(c->data.u, start_u, NU * sizeof(double));
    c->data.max_step = {{ max_step }};
    c->data.mode = INSTANTIATED;
{% if is_affine %}
    c->prepared = 0.0;
{% endif %}
}

static Status fail(Instance *c, const char *format, ...)
{
    char text[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (c->callbacks->log)
        c->callbacks->log(c->callbacks->environment, c->name, ERROR, "logStatusError", text); /* holds no per cent sign */
    return ERROR;
}

EXPORTED const char *FMI(fmi2GetTypesPlatform)(void) { return "default"; }

EXPORTED const char *FMI(fmi2GetVersion)(void) { return "2.0"; }

EXPORTED Status FMI(fmi2SetDebugLogging)(Component c, int on, size_t count, const char *const *categories)
{
    (void)c, (void)on, (void)count, (void)categories;
    return OK;
}

EXPORTED Component FMI(fmi2Instantiate)(const char *name, int kind, const char *guid, const char *resources,
                                        const Callbacks *callbacks, int visible, int logging)
{
    Instance *c;
    (void)resources, (void)visible, (void)logging;
    if (!callbacks || !callbacks->allocate || !callbacks->release || !name || kind != 1 || !guid) return NULL;
    if (strcmp(guid, "{{ guid }}") != 0) {
        if (callbacks->log)
            callbacks->log(callbacks->environment, name, ERROR, "logStatusError",
                           "the GUID is not that of modelDescription.xml; take both from one FMU");
        return NULL;
    }
    c = callbacks->allocate(1, sizeof *c);
    if (!c) return NULL;
    c->callbacks = callbacks;
    c->name[0] = '\0';
    strncat(c->name, name, sizeof c->name - 1);
    set_start(c);
    return c;
}

EXPORTED void FMI(fmi2FreeInstance)(Component component)
{
    if (component) ((Instance *)component)->callbacks->release(component);
}

EXPORTED Status FMI(fmi2SetupExperiment)(Component component, int has_tolerance, double tolerance, double start,
                                         int has_stop, double stop)
{
    (void)component, (void)has_tolerance, (void)tolerance, (void)start, (void)has_stop, (void)stop;
    return OK;
}

EXPORTED Status FMI(fmi2EnterInitializationMode)(Component component)
{
    Instance *c = component;
    if (c->data.mode != INSTANTIATED) return fail(c, "initialisation begins once, after instantiation or reset");
    c->data.mode = INITIALISING;
    return OK;
}

EXPORTED Status FMI(fmi2ExitInitializationMode)(Component component)
{
    Instance *c = component;
    double xdot[NX];
    int i;
    if (c->data.mode != INITIALISING) return fail(c, "initialisation ends before it has begun");
    {{ name }}_rates(&c->data.p, c->data.x, c->data.u, xdot);
    for (i = 0; i < NX; i++)
        if (!(fabs(xdot[i]) < HUGE_VAL)) {
            c->data.mode = FAILED;
            return fail(c, "the start values give no finite motion: the rate of state %d is %g", i, xdot[i]);
        }
    c->data.mode = STEPPING;
    return OK;
}

EXPORTED Status FMI(fmi2Terminate)(Component component)
{
    ((Instance *)component)->data.mode = TERMINATED;
    return OK;
}

EXPORTED Status FMI(fmi2Reset)(Component component)
{
    set_start(component);
    return OK;
}

static double real_value(const Instance *c, Reference r)
{
    double y[NY + 1];
    if (r < FIRST_INPUT) return c->data.x[r];
    if (r < FIRST_OUTPUT) return c->data.u[r - FIRST_INPUT];
    if (r < FIRST_PARAMETER) {
        {{ name }}_outputs(&c->data.p, c->data.x, c->data.u, y);
        return y[r - FIRST_OUTPUT];
    }
    if (r < MAX_STEP) return ((const double *)&c->data.p)[r - FIRST_PARAMETER];
    if (r == MAX_STEP) return c->data.max_step;
{% if has_range %}
    return {{ name }}_range_use(&c->data.p, c->data.x, c->data.u);
{% else %}
    return 0.0;
{% endif %}
}

EXPORTED Status FMI(fmi2GetReal)(Component component, const Reference *r, size_t count, double *value)
{
    size_t k;
    for (k = 0; k < count; k++) {
        if (r[k] >= {{ real_count }}) return fail(component, "no real variable has the reference %u", r[k]);
        value[k] = real_value(component, r[k]);
    }
    return OK;
}

static Status set_real(Instance *c, Reference r, double value)
{
    if (!(fabs(value) < HUGE_VAL)) return fail(c, "variable %u cannot be %g: give a finite number", r, value);
    if (r < FIRST_INPUT) {
        if (c->data.mode > INITIALISING) return fail(c, "state %u is set before the first step only, or by a saved state", r);
        c->data.x[r] = value;
    } else if (r < FIRST_OUTPUT) {
        c->data.u[r - FIRST_INPUT] = value;
    } else if (r >= FIRST_PARAMETER && r < MAX_STEP) {
        const unsigned i = r - FIRST_PARAMETER;
        if (value < lower[i] || value > upper[i])
            return fail(c, "parameter %u cannot be %g: its bounds are %g and %g", r, value, lower[i], upper[i]);
        ((double *)&c->data.p)[i] = value;
{% if is_affine %}
        c->prepared = 0.0;
{% endif %}
    } else if (r == MAX_STEP) {
        if (!(value > 0.0)) return fail(c, "max_step is a number of seconds above zero, not %g", value);
        c->data.max_step = value;
    } else
        return fail(c, "variable %u is calculated and cannot be set", r);
    return OK;
}

EXPORTED Status FMI(fmi2SetReal)(Component component, const Reference *r, size_t count, const double *value)
{
    size_t k;
    for (k = 0; k < count; k++) {
        const Status status = set_real(component, r[k], value[k]);
        if (status != OK) return status;
    }
    return OK;
}

EXPORTED Status FMI(fmi2GetBoolean)(Component component, const Reference *r, size_t count, int *value)
{
{% if has_range %}
    const Instance *c = component;
    size_t k;
    for (k = 0; k < count; k++) {
        if (r[k] != 0) return fail(component, "no boolean variable has the reference %u", r[k]);
        value[k] = {{ name }}_range_use(&c->data.p, c->data.x, c->data.u) > 1.0;
    }
    return OK;
{% else %}
    (void)r, (void)value;
    return count ? fail(component, "there is no boolean variable") : OK;
{% endif %}
}

{% for kind, type in (("Integer", "int"), ("String", "const char *")) %}
EXPORTED Status FMI(fmi2Get{{ kind }})(Component component, const Reference *r, size_t count, {{ type }} *value)
{
    (void)r, (void)value;
    return count ? fail(component, "there is no variable of this type") : OK;
}

{% endfor %}
{% for kind, type in (("Integer", "int"), ("Boolean", "int"), ("String", "const char *const")) %}
EXPORTED Status FMI(fmi2Set{{ kind }})(Component component, const Reference *r, size_t count, {{ "const int" if type == "int" else type }} *value)
{
    (void)r, (void)value;
    return count ? fail(component, "no variable of this type can be set") : OK;
}

{% endfor %}
EXPORTED Status FMI(fmi2GetFMUstate)(Component component, void **state)
{
    Instance *c = component;
    if (!*state) *state = c->callbacks->allocate(1, sizeof(Data));
    if (!*state) return fail(c, "there is no memory left for a saved state");
    memcpy(*state, &c->data, sizeof(Data));
    return OK;
}

EXPORTED Status FMI(fmi2SetFMUstate)(Component component, void *state)
{
    Instance *c = component;
    memcpy(&c->data, state, sizeof(Data));
{% if is_affine %}
    c->prepared = 0.0;
{% endif %}
    return OK;
}

EXPORTED Status FMI(fmi2FreeFMUstate)(Component component, void **state)
{
    if (*state) ((Instance *)component)->callbacks->release(*state);
    *state = NULL;
    return OK;
}

EXPORTED Status FMI(fmi2SerializedFMUstateSize)(Component component, void *state, size_t *size)
{
    (void)component, (void)state;
    *size = sizeof(Data);
    return OK;
}

EXPORTED Status FMI(fmi2SerializeFMUstate)(Component component, void *state, char bytes[], size_t size)
{
    if (size != sizeof(Data)) return fail(component, "a saved state of this FMU has %u bytes", (unsigned)sizeof(Data));
    memcpy(bytes, state, size);
    return OK;
}

EXPORTED Status FMI(fmi2DeSerializeFMUstate)(Component component, const char bytes[], size_t size, void **state)
{
    Instance *c = component;
    if (size != sizeof(Data)) return fail(c, "a saved state of this FMU has %u bytes", (unsigned)sizeof(Data));
    if (!*state) *state = c->callbacks->allocate(1, sizeof(Data));
    if (!*state) return fail(c, "there is no memory left for a saved state");
    memcpy(*state, bytes, size);
    return OK;
}

EXPORTED Status FMI(fmi2GetDirectionalDerivative)(Component component, const Reference *unknown, size_t unknowns,
                                                  const Reference *known, size_t knowns, const double *seed, double *value)
{
    (void)unknown, (void)unknowns, (void)known, (void)knowns, (void)seed, (void)value;
    return fail(component, "directional derivatives are not offered");
}

/* First derivatives of the inputs hold for the next step alone. */
EXPORTED Status FMI(fmi2SetRealInputDerivatives)(Component component, const Reference *r, size_t count, const int *order,
                                                 const double *value)
{
    Instance *c = component;
    size_t k;
    for (k = 0; k < count; k++) {
        if (r[k] < FIRST_INPUT || r[k] >= FIRST_OUTPUT) return fail(c, "variable %u is no input", r[k]);
        if (order[k] != 1) return fail(c, "inputs run straight: derivatives of order %d are not heeded", order[k]);
        if (!(fabs(value[k]) < HUGE_VAL)) return fail(c, "the derivative of input %u is %g", r[k], value[k]);
        c->data.slope[r[k] - FIRST_INPUT] = value[k];
    }
    return OK;
}

EXPORTED Status FMI(fmi2GetRealOutputDerivatives)(Component component, const Reference *r, size_t count, const int *order,
                                                  double *value)
{
    (void)r, (void)order, (void)value;
    return count ? fail(component, "derivatives of outputs are not offered") : OK;
}

EXPORTED Status FMI(fmi2DoStep)(Component component, double time, double step, int no_return)
{
    Instance *c = component;
    Data *d = &c->data;
    double u0[NU + 1], u1[NU + 1], size = 0.0;
    long k, count;
    int i;
    (void)no_return;
    if (d->mode != STEPPING) return fail(c, "a step needs an initialised instance that has not failed");
    if (!(step > 0.0 && step / d->max_step < 1e9)) return fail(c, "a step of %g s is not possible", step);
    count = (long)ceil(step / d->max_step - 1e-9);
    if (count < 1) count = 1;
{% if is_affine %}
    if (c->prepared != step / count) {
        c->prepared = step / count;
        {{ name }}_prepare(&d->p, c->prepared, &c->m);
    }
{% endif %}
    for (i = 0; i < NU; i++) u1[i] = d->u[i];
    for (k = 1; k <= count; k++) {
        for (i = 0; i < NU; i++) {
            u0[i] = u1[i];
            u1[i] = d->u[i] + d->slope[i] * (step * k / count);
        }
        {{ name }}_step({{ "&c->m, u0, u1" if is_affine else "&d->p, u0, u1, step / count" }}, d->x);
    }
    for (i = 0; i < NX; i++) size += fabs(d->x[i]);
    for (i = 0; i < NU; i++) d->slope[i] = 0.0;
    if (!(size < {{ diverged }})) {
        d->mode = FAILED;
        return fail(c, "the simulation left all bounds in the step from %g s", time);
    }
    return OK;
}

EXPORTED Status FMI(fmi2CancelStep)(Component component) { return fail(component, "a step cannot be cancelled"); }

{% for kind, type in (("", "Status"), ("Real", "double"), ("Integer", "int"), ("Boolean", "int"), ("String", "const char *")) %}
EXPORTED Status FMI(fmi2Get{{ kind }}Status)(Component component, int what, {{ type }} *value)
{
    (void)component, (void)what, (void)value;
    return DISCARD;
}

{% endfor %}
