// Angles to the last digits: devices may approximate inverse trigonometric functions to three or four, which moves what an environment shows by
// a hundredth of a texel and a solid angle by as much.

// The angle of the vector (x, y) from the x axis, -pi to pi, to 2 units in the last place; that of nothing is 0. The polynomial, for up to an
// eighth of a turn, is that of Moshier's Cephes library (atanf).
float angle_of(float y, float x) {
    float across = abs(y), along = abs(x);
    float greater = max(across, along), lesser = min(across, along);
    if (greater == 0.0) return 0.0;
    float t = lesser / greater;
    bool far = t > 0.41421356; // the tangent of a sixteenth of a turn
    if (far) t = (t - 1.0) / (t + 1.0);
    float z = t * t;
    float angle = (((8.05374449538e-2 * z - 1.38776856032e-1) * z + 1.99777106478e-1) * z - 3.33329491539e-1) * z * t + t;
    if (far) angle += 0.25 * PI;
    if (across > along) angle = 0.5 * PI - angle;
    if (x < 0.0) angle = PI - angle;
    return y < 0.0 ? -angle : angle;
}

// Where the direction (x, y, z) lies on the sphere around +z, in turns: around the axis from x towards y, 0 to 1, and half turns from the pole.
vec2 sphere_place(vec3 d) {
    float turn = angle_of(d.y, d.x) * (0.5 * INV_PI);
    return vec2(turn < 0.0 ? turn + 1.0 : turn, angle_of(length(d.xy), d.z) * INV_PI);
}
