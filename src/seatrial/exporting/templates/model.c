{% for line in head %}
/* {{ line }} */
{% endfor %}
/* Bindings, with the source of each:
{% for b, unit, source in bindings %}
 *   {{ b }} [{{ unit }}]: {{ source }}
{% endfor %}
 */
#include "{{ name }}.h"

#include <math.h>

#define NX {{ NAME }}_NX
#define NU {{ NAME }}_NU
#define NY {{ NAME }}_NY
#define NZ {{ NAME }}_NZ

const {{ name }}_parameters {{ name }}_identified = {
{% for v, value in parameters %}
    {{ value }}, /* {{ v.name }} */
{% else %}
    0.0,
{% endfor %}
};

{% if has_angles %}
/* Sine and cosine together: Cody & Waite 1980, chapter 8, then Taylor series on a quarter turn by Estrin's scheme. */
static void sincos_of(double angle, double *sine, double *cosine)
{
    static const double S[] = { {{ sine_series }} };
    static const double C[] = { {{ cosine_series }} };
    const int in_range = fabs(angle) < 1e5;
    const int k = in_range ? (int)(angle * {{ two_over_pi }} + (angle < 0.0 ? -0.5 : 0.5)) : 0;
    const double r = ((angle - k * {{ half_pi[0] }}) - k * {{ half_pi[1] }}) - k * {{ half_pi[2] }};
    const double z = r * r, z2 = z * z, z4 = z2 * z2;
    const double s = r + r * z * (((S[0] + z * S[1]) + z2 * (S[2] + z * S[3]))
                                  + z4 * ((S[4] + z * S[5]) + z2 * (S[6] + z * S[7])));
    const double c = 1.0 + z * (((C[0] + z * C[1]) + z2 * (C[2] + z * C[3]))
                                + z4 * ((C[4] + z * C[5]) + z2 * (C[6] + z * (C[7] + z * C[8]))));
    const unsigned quadrant = (unsigned)k & 3u;
    if (!in_range) {
        *sine = sin(angle);
        *cosine = cos(angle);
        return;
    }
    *sine = quadrant & 1u ? c : s;
    *cosine = quadrant & 1u ? s : c;
    if (quadrant & 2u) *sine = -*sine;
    if (quadrant == 1u || quadrant == 2u) *cosine = -*cosine;
}

{% endif %}
static void rates(const {{ name }}_parameters *p, const double *x, const double *u, double *out)
{
    (void)p, (void)x, (void)u;
{% for line in rates %}
    {{ line }}
{% endfor %}
}

void {{ name }}_rates(const {{ name }}_parameters *p, const double *x, const double *u, double *xdot)
{
    rates(p, x, u, xdot);
}

void {{ name }}_outputs(const {{ name }}_parameters *p, const double *x, const double *u, double *out)
{
    (void)p, (void)x, (void)u, (void)out;
{% for line in outputs_body %}
    {{ line }}
{% endfor %}
}

void {{ name }}_rates_jacobian(const {{ name }}_parameters *p, const double *x, const double *u, double *out, double *jac)
{
    int i;
    (void)p, (void)x, (void)u;
    for (i = 0; i < NX * NZ; i++) jac[i] = 0.0;
{% for line in rates_jacobian %}
    {{ line }}
{% endfor %}
}

void {{ name }}_outputs_jacobian(const {{ name }}_parameters *p, const double *x, const double *u, double *out, double *jac)
{
    int i;
    (void)p, (void)x, (void)u, (void)out;
    for (i = 0; i < NY * NZ; i++) jac[i] = 0.0;
{% for line in outputs_jacobian %}
    {{ line }}
{% endfor %}
}

{% if is_affine %}
{% include "propagator.c" %}
{% else %}
/* Hairer, Norsett & Wanner 1993, table II.1.2 */
void {{ name }}_step(const {{ name }}_parameters *p, const double *u0, const double *u1, double h, double *x)
{
    double k1[NX], k2[NX], k3[NX], k4[NX], y[NX], um[NU + 1], ub[NU + 1];
    int i;
    for (i = 0; i < NU; i++) {
        const double half = 0.5 * (u1[i] - u0[i]);
        um[i] = u0[i] + half;
        ub[i] = um[i] + half;
    }
    rates(p, x, u0, k1);
    for (i = 0; i < NX; i++) y[i] = x[i] + 0.5 * h * k1[i];
    rates(p, y, um, k2);
    for (i = 0; i < NX; i++) y[i] = x[i] + 0.5 * h * k2[i];
    rates(p, y, um, k3);
    for (i = 0; i < NX; i++) y[i] = x[i] + h * k3[i];
    rates(p, y, ub, k4);
    for (i = 0; i < NX; i++) x[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
}
{% endif %}
{% if has_range %}

double {{ name }}_range_use(const {{ name }}_parameters *p, const double *x, const double *u)
{
    double out[1];
    (void)p, (void)x, (void)u;
{% for line in range_body %}
    {{ line }}
{% endfor %}
    return out[0];
}
{% endif %}
