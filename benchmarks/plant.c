/* The plant's equations and integrator as in sim_backend/plant, in C: the yardstick for the compiled kernel. */
#include <math.h>

enum {
    KIND, J_M, N, K_S, D_S, J_W, K_T, D_T, J_V, DELAY, LAG, SATURATION, RATE, DEADBAND, GAP, CUBIC, K_H, SLIP_RAD,
    COULOMB, STRIBECK, OFFSET, DRAG, J_H, K_M, D_M, W_ORDER, W_AMPLITUDE, W_PHASE, M_ORDER, M_AMPLITUDE, M_PHASE,
    ROLLING, AERO
};
enum { ROTOR, TWIST, WHEEL, TYRE, VEHICLE, ANGLE, LAGGED, H_ANGLE, HOUSING, SLIP, STATES };

static double shaft(const double *x, const double *p)
{
    double v = x[HOUSING] + (x[ROTOR] - x[HOUSING]) / p[N] - x[WHEEL], e = x[TWIST], t;
    if (p[GAP] > 0.0) {
        if (e > p[GAP]) { e -= p[GAP]; t = fmax(0.0, p[K_S] * e + p[D_S] * v); }
        else if (e < -p[GAP]) { e += p[GAP]; t = fmin(0.0, p[K_S] * e + p[D_S] * v); }
        else { e = 0.0; t = 0.0; }
    } else t = p[K_S] * e + p[D_S] * v;
    t += p[CUBIC] * e * e * e + p[K_H] * x[SLIP];
    if (p[W_AMPLITUDE] != 0.0) t += p[W_AMPLITUDE] * sin(p[W_ORDER] * x[ANGLE] + p[W_PHASE]);
    return t;
}

static double losses(const double *x, const double *p)
{
    double speed = x[ROTOR] - x[HOUSING], loss = p[DRAG] * speed + p[OFFSET];
    if (p[COULOMB] != 0.0 || p[STRIBECK] != 0.0) {
        double r = speed / 2.0;
        loss += (p[COULOMB] + p[STRIBECK] * exp(-r * r)) * tanh(speed / 0.2);
    }
    if (p[M_AMPLITUDE] != 0.0)
        loss -= p[M_AMPLITUDE] * sin(p[M_ORDER] * p[N] * (x[TWIST] + x[ANGLE] - x[H_ANGLE]) + p[M_PHASE]);
    return loss;
}

static double resistance(double speed, const double *p)
{
    if (p[ROLLING] == 0.0 && p[AERO] == 0.0) return 0.0;
    return p[ROLLING] * tanh(speed / 0.05) + p[AERO] * speed * fabs(speed);
}

static double road(const double *x, const double *p)
{
    return p[K_T] * x[TYRE] + p[D_T] * (x[WHEEL] - x[VEHICLE]);
}

static void derivative(const double *x, const double *p, double torque, double *d)
{
    double lagged = 0.0;
    if (p[LAG] > 0.0) { lagged = (torque - x[LAGGED]) / p[LAG]; torque = x[LAGGED]; }
    double relative = x[ROTOR] - x[HOUSING], v = x[HOUSING] + relative / p[N] - x[WHEEL];
    double s = shaft(x, p), loss = losses(x, p), housing = 0.0, slip = 0.0;
    if (p[J_H] > 0.0)
        housing = (loss - torque + s / p[N] - s - p[K_M] * x[H_ANGLE] - p[D_M] * x[HOUSING]) / p[J_H];
    if (p[K_H] != 0.0) {
        double r = x[SLIP] / p[SLIP_RAD];
        slip = r * v <= 0.0 ? v : v * (1.0 - r * r);
    }
    double t = road(x, p);
    d[ROTOR] = (torque - loss - s / p[N]) / p[J_M];
    d[TWIST] = v;
    d[WHEEL] = (s - t) / p[J_W];
    d[TYRE] = x[WHEEL] - x[VEHICLE];
    d[VEHICLE] = (t - resistance(x[VEHICLE], p)) / p[J_V];
    d[ANGLE] = x[WHEEL];
    d[LAGGED] = lagged;
    d[H_ANGLE] = x[HOUSING];
    d[HOUSING] = housing;
    d[SLIP] = slip;
}

static void steps(double *x, const double *p, double torque, double duration, int count)
{
    double h = duration / count;
    for (int n = 0; n < count; n++) {
        double a[STATES], b[STATES], c[STATES], d[STATES], y[STATES];
        derivative(x, p, torque, a);
        for (int i = 0; i < STATES; i++) y[i] = x[i] + 0.5 * h * a[i];
        derivative(y, p, torque, b);
        for (int i = 0; i < STATES; i++) y[i] = x[i] + 0.5 * h * b[i];
        derivative(y, p, torque, c);
        for (int i = 0; i < STATES; i++) y[i] = x[i] + h * c[i];
        derivative(y, p, torque, d);
        for (int i = 0; i < STATES; i++) x[i] += h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]);
    }
}

static int steps_for(double duration, double longest) { return (int)fmax(1.0, ceil(duration / longest - 1e-9)); }

void run(const double *torque, long samples, double dt, const double *p, double longest, double *out)
{
    long whole = (long)floor(p[DELAY] / dt + 1e-9);
    double late = fmax(0.0, p[DELAY] - whole * dt), x[STATES] = {0};
    if (late < 1e-9 * dt) late = 0.0;
    for (long k = 0; k < samples; k++) {
        double fresh = torque[k - whole > 0 ? k - whole : 0], old = torque[k - whole - 1 > 0 ? k - whole - 1 : 0];
        double *row = out + 6 * k;
        row[0] = x[ROTOR] - x[HOUSING];
        row[1] = x[WHEEL];
        row[2] = shaft(x, p);
        row[3] = fresh;
        row[4] = x[VEHICLE];
        row[5] = road(x, p);
        if (late > 0.0) steps(x, p, old, late, steps_for(late, longest));
        if (late < dt) steps(x, p, fresh, dt - late, steps_for(dt - late, longest));
    }
}
