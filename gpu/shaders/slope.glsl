// Slopes of a surface that are seen from a direction: core/slope.h in float.

// A Gaussian of slopes: mean; cov = (var_x, var_y, cov_xy).
struct dif_gauss {
    vec2 mean;
    vec3 cov;
};

// What is seen of it: the visible slopes' Gaussian, their norm (below 1e-38: 0), and its logarithm, which does not underflow.
struct dif_seen {
    dif_gauss gauss;
    float norm, ln_norm;
};

// Standard normal distribution, to 1.5e-7 absolute.                       Abramowitz and Stegun 7.1.26
float dif_normal_below(float z)
{
    float x = abs(z) * 0.70710678, t = 1.0 / (1.0 + 0.3275911 * x);
    float tail = 0.5 * t * (0.254829592 + t * (-0.284496736 + t * (1.421413741 + t * (-1.453152027 + t * 1.061405429)))) *
                 dif_exp_minus(x * x);
    return z < 0.0 ? tail : 1.0 - tail;
}

// The standard normal weighted by max(0, z - T): mean, variance, ln psi, to 1e-6 of each and 1e-6 absolute of ln psi for
// z in [-1, 6], relative for z below.  By a continued fraction in the tail, where 40 terms do; by polynomials up to 1, whose
// error is 1e-8 where the closed form would cancel; by the closed form up to 6, above which nothing is turned away.
vec3 dif_slope_cut(float z)
{
    if (z < -2.0) {
        float x = -z, r = 0.0, r3 = 0.0, r2 = 0.0, r1 = 0.0;
        for (int n = 40; n >= 0; n--) {
            r1 = n == 0 ? r : r1;
            r = 1.0 / (x + float(n + 1) * r);
            r3 = n == 3 ? r : r3;
            r2 = n == 2 ? r : r2;
        }
        return vec3(z - 2.0 * r2, 2.0 * r2 * (3.0 * r3 - 2.0 * r2), -0.5 * z * z - 0.918938533 + log(r * r1));
    }
    if (z < 1.0) {
        float t = (z + 0.5) * (2.0 / 3.0);
        vec3 sum = vec3(5.16719929e-6, -3.15369851e-5, 3.4410388e-6);
        sum = sum * t + vec3(-2.0942644e-5, -3.74853106e-5, 1.79075624e-5);
        sum = sum * t + vec3(-0.000118979193, 0.000196826505, 1.31694337e-5);
        sum = sum * t + vec3(-7.42376867e-5, 0.000640671624, -0.000176179209);
        sum = sum * t + vec3(0.000831049531, 0.000290883052, -0.000779793106);
        sum = sum * t + vec3(0.00312180246, -0.00332824669, -0.000478058938);
        sum = sum * t + vec3(0.0015907919, -0.0103885648, 0.0118269239);
        sum = sum * t + vec3(-0.0315390914, -0.00424113662, 0.0852314872);
        sum = sum * t + vec3(-0.170462686, 0.0630763025, -0.734926129);
        sum = sum * t + vec3(0.979901545, 0.22728352, 2.33980972);
        return sum * t + vec3(-1.55987315, 0.346732335, -1.62051626);
    }
    if (z > 6.0)
        return vec3(-1.0 / z, 1.0 - 1.0 / (z * z), log(z));
    float below = dif_normal_below(z), psi = z * below + 0.398942280 * dif_exp_minus(0.5 * z * z), ratio = below / psi;
    return vec3(-ratio, 2.0 - z * ratio - ratio * ratio, log(psi));
}

// The slopes of a Gaussian that are seen from a direction: unit, z >= 0.  Straight from above all are; where nothing is
// seen, they stay as they are and norm is 0.
dif_seen dif_slope_visible(dif_gauss g, vec3 view)
{
    float sine = length(view.xy);
    vec2 o = sine > 0.0 ? view.xy / sine : vec2(1.0, 0.0), p = vec2(-o.y, o.x);
    float vo = max(g.cov.x * o.x * o.x + 2.0 * g.cov.z * o.x * o.y + g.cov.y * o.y * o.y, 0.0);
    float vp = max(g.cov.x * o.y * o.y - 2.0 * g.cov.z * o.x * o.y + g.cov.y * o.x * o.x, 0.0);
    float sd = sqrt(vo), most = sd * sqrt(vp), mo = dot(g.mean, o), mp = dot(g.mean, p);
    float c = clamp((g.cov.y - g.cov.x) * o.x * o.y + g.cov.z * (o.x * o.x - o.y * o.y), -most, most);
    float a = view.z - mo * sine, b = sd * sine;
    if (b <= 0.0)
        return dif_seen(g, max(a, 0.0), log(max(a, 0.0)));
    bool far = a > 6.0 * b; // also where a / b would be infinite
    float share = b / a, along = c / sd;
    vec3 cut = far ? vec3(-share, 1.0 - share * share, 0.0) : dif_slope_cut(a / b);
    float ln_norm = far ? log(a) : log(b) + cut.z;
    float norm = far ? a : b * (cut.z > 0.0 ? 1.0 / dif_exp_minus(cut.z) : dif_exp_minus(-cut.z));
    float voo = vo * cut.y, vop = c * cut.y, vpp = max(vp - along * along * (1.0 - cut.y), 0.0);
    mo += sd * cut.x;
    mp += along * cut.x;
    vec3 cov = vec3(voo * o.x * o.x - 2.0 * vop * o.x * o.y + vpp * o.y * o.y,
                    voo * o.y * o.y + 2.0 * vop * o.x * o.y + vpp * o.x * o.x,
                    (voo - vpp) * o.x * o.y + vop * (o.x * o.x - o.y * o.y));
    return dif_seen(dif_gauss(mo * o + mp * p, cov), norm, ln_norm);
}
