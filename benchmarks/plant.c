/* The chain's equations and integrator as in hil/plant, in C: the yardstick for the compiled kernel.
 *
 * slots.h is made by benchmarks/c_plant.py from hil/plant/_slots.py: `#define AT_gear_ratio 2`, and so on. Three
 * inertias with drag, lag and the order of the wheel; whatever else the vector holds must be off, which the same
 * module checks before it calls `run`.
 */
#include <math.h>
#include "slots.h"

enum { ROTOR, TWIST, WHEEL, TYRE, VEHICLE, ANGLE, LAGGED, STATES };

static double shaft(const double *x, const double *p)
{
    double v = x[ROTOR] / p[AT_gear_ratio] - x[WHEEL];
    double t = p[AT_shaft_stiffness] * x[TWIST] + p[AT_shaft_damping] * v;
    double amplitude = p[AT_wheel_order_disturbance_amplitude_nm];
    if (amplitude != 0.0)
        t += amplitude * sin(p[AT_wheel_order_disturbance_order] * x[ANGLE] + p[AT_wheel_order_disturbance_phase_rad]);
    return t;
}

static double road(const double *x, const double *p)
{
    return p[AT_tyre_stiffness] * x[TYRE] + p[AT_tyre_damping] * (x[WHEEL] - x[VEHICLE]);
}

static void derivative(const double *x, const double *p, double torque, double *d)
{
    double lagged = 0.0;
    if (p[AT_torque_lag] > 0.0) { lagged = (torque - x[LAGGED]) / p[AT_torque_lag]; torque = x[LAGGED]; }
    double s = shaft(x, p), t = road(x, p);
    d[ROTOR] = (torque - p[AT_viscous_drag] * x[ROTOR] - s / p[AT_gear_ratio]) / p[AT_motor_inertia];
    d[TWIST] = x[ROTOR] / p[AT_gear_ratio] - x[WHEEL];
    d[WHEEL] = (s - t) / p[AT_wheel_inertia];
    d[TYRE] = x[WHEEL] - x[VEHICLE];
    d[VEHICLE] = t / p[AT_vehicle_inertia];
    d[ANGLE] = x[WHEEL];
    d[LAGGED] = lagged;
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
    long whole = (long)floor(p[AT_torque_delay] / dt + 1e-9);
    double late = fmax(0.0, p[AT_torque_delay] - whole * dt), acted = 0.0, x[STATES] = {0};
    if (late < 1e-9 * dt) late = 0.0;
    for (long k = 0; k < samples; k++) {
        double fresh = k >= whole ? torque[k - whole] : 0.0, old = k > whole ? torque[k - whole - 1] : 0.0;
        double *row = out + 6 * k;
        row[0] = x[ROTOR];
        row[1] = x[WHEEL];
        row[2] = shaft(x, p);
        row[3] = acted;
        row[4] = x[VEHICLE];
        row[5] = road(x, p);
        if (late > 0.0) steps(x, p, old, late, steps_for(late, longest));
        if (late < dt) steps(x, p, fresh, dt - late, steps_for(dt - late, longest));
        acted = fresh;
    }
}
