{% for line in head %}
/* {{ line }} */
{% endfor %}
#ifndef {{ NAME }}_H
#define {{ NAME }}_H

/* Numbers of states, inputs, outputs and parameters. */
#define {{ NAME }}_NX {{ states|length }}
#define {{ NAME }}_NU {{ inputs|length }}
#define {{ NAME }}_NY {{ outputs|length }}
#define {{ NAME }}_NP {{ parameters|length }}
#define {{ NAME }}_NZ ({{ NAME }}_NX + {{ NAME }}_NU + {{ NAME }}_NP) /* columns of a Jacobian: [x | u | p] */

/* States x, SI. */
{% for v in states %}
#define {{ NAME }}_X_{{ v.name }} {{ loop.index0 }} /* {{ v.unit and v.unit + ": " }}{{ v.note }} */
{% endfor %}

/* Inputs u, SI. */
{% for v in inputs %}
#define {{ NAME }}_U_{{ v.name }} {{ loop.index0 }} /* {{ v.unit and v.unit + ": " }}{{ v.note }} */
{% endfor %}

/* Outputs y, SI. */
{% for v in outputs %}
#define {{ NAME }}_Y_{{ v.name }} {{ loop.index0 }} /* {{ v.unit and v.unit + ": " }}{{ v.note }} */
{% endfor %}

typedef struct {
{% for v, _ in parameters %}
    double {{ v.name }}; /* {{ v.unit }}: {{ v.note }} */
{% else %}
    double unused;
{% endfor %}
} {{ name }}_parameters;

/* The identified values. */
extern const {{ name }}_parameters {{ name }}_identified;

/* xdot[NX] = f(x[NX], u[NU]). */
void {{ name }}_rates(const {{ name }}_parameters *p, const double *x, const double *u, double *xdot);

/* y[NY] = g(x[NX], u[NU]). */
void {{ name }}_outputs(const {{ name }}_parameters *p, const double *x, const double *u, double *y);

/* Rates with their exact Jacobian, NX rows of NZ columns [x | u | p]. */
void {{ name }}_rates_jacobian(const {{ name }}_parameters *p, const double *x, const double *u, double *xdot,
                               double *jac);

/* Outputs with their exact Jacobian, NY rows of NZ columns [x | u | p]. */
void {{ name }}_outputs_jacobian(const {{ name }}_parameters *p, const double *x, const double *u, double *y,
                                 double *jac);

{% if is_affine %}
/* Exact propagator over a step: x <- e x + g0 [u0; 1] + g1 [u1; 1] (Higham 2008, section 10.7). */
typedef struct {
    double e[{{ NAME }}_NX * {{ NAME }}_NX];
    double g0[{{ NAME }}_NX * ({{ NAME }}_NU + 1)];
    double g1[{{ NAME }}_NX * ({{ NAME }}_NU + 1)];
} {{ name }}_propagator;

/* Set the propagator for a step of h seconds; NaN where the model is too stiff for the step. */
void {{ name }}_prepare(const {{ name }}_parameters *p, double h, {{ name }}_propagator *m);

/* Advance x over the prepared step; inputs run straight from u0 to u1, those that the model holds stay at u0. */
void {{ name }}_step(const {{ name }}_propagator *m, const double *u0, const double *u1, double *x);
{% else %}
/* Advance x over h seconds by the classical Runge-Kutta scheme; inputs run straight from u0 to u1. */
void {{ name }}_step(const {{ name }}_parameters *p, const double *u0, const double *u1, double h, double *x);
{% endif %}
{% if has_range %}

/* How far the motion uses the identified range: above 1 the coefficients have not been seen to hold. */
double {{ name }}_range_use(const {{ name }}_parameters *p, const double *x, const double *u);
{% endif %}

#endif
