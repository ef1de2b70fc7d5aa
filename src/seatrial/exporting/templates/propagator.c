/* out += factor a b */
static void add_product(const double *a, const double *b, double factor, double *out)
{
    int i, j, k;
    for (i = 0; i < NX; i++)
        for (k = 0; k < NX; k++) {
            const double scaled = factor * a[i * NX + k];
            for (j = 0; j < NX; j++) out[i * NX + j] += scaled * b[k * NX + j];
        }
}

static void fill(double *a, double value)
{
    int i;
    for (i = 0; i < NX * NX; i++) a[i] = value;
}

/* e = exp(A h), held = h phi_1(A h), ramp = h phi_2(A h): Taylor series of the scaled matrix, then doubling. */
static void exponentials(const double *a, double h, double *e, double *held, double *ramp)
{
    double term[NX * NX], next[NX * NX], size = 0.0, step;
    int i, j, k, halvings = 0;
    for (i = 0; i < NX; i++) {
        double row = 0.0;
        for (j = 0; j < NX; j++) row += fabs(a[i * NX + j]);
        if (row > size) size = row;
    }
    for (size *= h; size > 0.25 && halvings < 60; halvings++) size *= 0.5;
    if (halvings >= 60) {
        const double none = nan("");
        fill(e, none), fill(held, none), fill(ramp, none);
        return;
    }
    step = ldexp(h, -halvings);
    fill(term, 0.0), fill(e, 0.0), fill(held, 0.0), fill(ramp, 0.0);
    for (i = 0; i < NX; i++) {
        term[i * NX + i] = e[i * NX + i] = held[i * NX + i] = 1.0;
        ramp[i * NX + i] = 0.5;
    }
    for (k = 1; k <= 11; k++) {
        const double first = 1.0 / (k + 1), second = 1.0 / ((k + 1.0) * (k + 2.0));
        fill(next, 0.0);
        add_product(term, a, step / k, next);
        for (i = 0; i < NX * NX; i++) {
            term[i] = next[i];
            e[i] += next[i];
            held[i] += next[i] * first;
            ramp[i] += next[i] * second;
        }
    }
    for (k = 0; k < halvings; k++) {
        fill(term, 0.0), fill(next, 0.0);
        add_product(e, ramp, 1.0, term);
        add_product(e, held, 1.0, next);
        for (i = 0; i < NX * NX; i++) {
            ramp[i] = 0.25 * (term[i] + held[i] + ramp[i]);
            held[i] = 0.5 * (next[i] + held[i]);
        }
        fill(term, 0.0);
        add_product(e, e, 1.0, term);
        for (i = 0; i < NX * NX; i++) e[i] = term[i];
    }
    for (i = 0; i < NX * NX; i++) held[i] *= h, ramp[i] *= h;
}

void {{ name }}_prepare(const {{ name }}_parameters *p, double h, {{ name }}_propagator *m)
{
    static const double smooth[NU + 1] = { {% for h in is_held %}{{ 0.0 if h else 1.0 }}, {% endfor %}0.0 };
    double a[NX * NX], b[NX * (NU + 1)], held[NX * NX], ramp[NX * NX], c[NX], jac[NX * NZ], x[NX], u[NU + 1];
    int i, j, k;
    for (i = 0; i < NX; i++) x[i] = 0.0;
    for (j = 0; j <= NU; j++) u[j] = 0.0;
    {{ name }}_rates_jacobian(p, x, u, c, jac);
    for (i = 0; i < NX; i++) {
        for (k = 0; k < NX; k++) a[i * NX + k] = jac[i * NZ + k];
        for (j = 0; j < NU; j++) b[i * (NU + 1) + j] = jac[i * NZ + NX + j];
        b[i * (NU + 1) + NU] = c[i];
    }
    exponentials(a, h, m->e, held, ramp);
    for (i = 0; i < NX; i++)
        for (j = 0; j <= NU; j++) {
            double by_ramp = 0.0, by_hold = 0.0;
            for (k = 0; k < NX; k++) {
                by_ramp += ramp[i * NX + k] * b[k * (NU + 1) + j];
                by_hold += held[i * NX + k] * b[k * (NU + 1) + j];
            }
            m->g1[i * (NU + 1) + j] = smooth[j] * by_ramp;
            m->g0[i * (NU + 1) + j] = by_hold - m->g1[i * (NU + 1) + j];
        }
}

void {{ name }}_step(const {{ name }}_propagator *m, const double *u0, const double *u1, double *x)
{
    double y[NX];
    int i, j, k;
    for (i = 0; i < NX; i++) {
        double total = 0.0;
        for (k = 0; k < NX; k++) total += m->e[i * NX + k] * x[k];
        for (j = 0; j < NU; j++) total += m->g0[i * (NU + 1) + j] * u0[j] + m->g1[i * (NU + 1) + j] * u1[j];
        y[i] = total + m->g0[i * (NU + 1) + NU];
    }
    for (i = 0; i < NX; i++) x[i] = y[i];
}
