//! Closed forms that rows and tests hold measurements against.

use glam::DVec3;

/// Irradiance at `p` of a polygon of radiance 1, over the part of it above the horizon of normal `n` (Lambert 1760; Baum, Rushmeier and
/// Winget 1989): half the sum over its edges of the angle that they span times the cosine of their plane's normal.
pub fn polygon_irradiance(corners: &[DVec3], p: DVec3, n: DVec3) -> f64 {
    // The part above the horizon, cut there (Sutherland and Hodgman 1974).
    let mut above = Vec::new();
    for (a, b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
        let (ha, hb) = ((*a - p).dot(n), (*b - p).dot(n));
        if ha >= 0.0 {
            above.push((*a - p).normalize());
        }
        if ha * hb < 0.0 {
            above.push((a.lerp(*b, ha / (ha - hb)) - p).normalize());
        }
    }
    let edges = above.iter().zip(above.iter().cycle().skip(1));
    let sum: f64 =
        edges.map(|(a, b)| a.cross(*b).length().atan2(a.dot(*b)) * a.cross(*b).normalize_or_zero().dot(n)).sum();
    0.5 * sum.abs()
}

/// Solid angle of a triangle with these corners, seen from the origin (van Oosterom and Strackee 1983).
pub fn triangle_solid_angle(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    let [a, b, c] = [a, b, c].map(DVec3::normalize);
    2.0 * a.dot(b.cross(c)).abs().atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a))
}
