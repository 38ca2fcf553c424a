//! Polygons as triangles: inside of the polygon, whatever its shape.

use std::collections::VecDeque;

use glam::{DVec2, DVec3};

/// The most corners of a polygon that is not cut by a fan: the time that the others take grows with their square.
pub(super) const MAX_CORNERS: usize = 1 << 13;

/// Cuts a polygon of three corners or more into triangles, of indices into `corners`, in the order of its corners. The message says what
/// is wrong with it.
///
/// A fan around the first corner serves where all its triangles turn the same way; else ears are clipped (Meisters 1975). Where the polygon
/// is not flat, its normal is Newell's (Tampieri 1992). Polygons that cross themselves have no inside: what is left of them when there is no
/// ear becomes a fan.
pub(super) fn triangulate(corners: &[DVec3], mut push: impl FnMut([usize; 3])) -> Result<(), String> {
    let count = corners.len();
    if count == 3 {
        push([0, 1, 2]);
        return Ok(());
    }
    let normal = newell(corners);
    let first = corners[0];
    let turns = |pair: &[DVec3]| (pair[0] - first).cross(pair[1] - first).dot(normal) > 0.0;
    // Nothing is known of a polygon without area.
    if normal == DVec3::ZERO || !normal.is_finite() || corners[1..].windows(2).all(turns) {
        (1..count - 1).for_each(|index| push([0, index, index + 1]));
        return Ok(());
    }
    if count > MAX_CORNERS {
        return Err(format!(
            "a polygon that is not convex has {count} corners, and {MAX_CORNERS} is the most that is read"
        ));
    }
    let flat: Vec<DVec2> = corners.iter().map(|corner| flatten(*corner - first, normal)).collect();
    clip_ears(&flat, push);
    Ok(())
}

/// Cuts polygons, which are so many of `indices` each, one after the other; all indices must exist.
pub(super) fn cut(
    positions: &[DVec3],
    mut indices: &[u32],
    counts: impl Iterator<Item = usize>,
) -> Result<Vec<[u32; 3]>, String> {
    let mut triangles = Vec::with_capacity(indices.len() / 3);
    let mut corners = Vec::new();
    for count in counts {
        let (polygon, rest) = indices.split_at(count);
        indices = rest;
        corners.clear();
        corners.extend(polygon.iter().map(|vertex| positions[*vertex as usize]));
        triangulate(&corners, |triangle| triangles.push(triangle.map(|corner| polygon[corner])))?;
    }
    Ok(triangles)
}

/// The polygon's normal, twice its area long.
fn newell(corners: &[DVec3]) -> DVec3 {
    let first = corners[0];
    corners[1..].windows(2).map(|pair| (pair[0] - first).cross(pair[1] - first)).sum()
}

/// The two coordinates that the normal leaves the most area, in the order that keeps the polygon counter-clockwise.
fn flatten(point: DVec3, normal: DVec3) -> DVec2 {
    let size = normal.abs();
    let (x, y, along) = if size.x >= size.y && size.x >= size.z {
        (point.y, point.z, normal.x)
    } else if size.y >= size.z {
        (point.z, point.x, normal.y)
    } else {
        (point.x, point.y, normal.z)
    };
    if along < 0.0 { DVec2::new(y, x) } else { DVec2::new(x, y) }
}

/// Twice the area of a triangle, negative where it runs clockwise.
fn area(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

/// Clips ears off a counter-clockwise polygon.
fn clip_ears(points: &[DVec2], mut push: impl FnMut([usize; 3])) {
    let count = points.len();
    let mut next: Vec<usize> = (1..count).chain([0]).collect();
    let mut previous: Vec<usize> = [count - 1].into_iter().chain(0..count - 1).collect();
    let is_convex =
        |previous: &[usize], next: &[usize], at: usize| area(points[previous[at]], points[at], points[next[at]]) > 0.0;
    // Where any corner lies inside an ear, one that is not convex does.
    let mut concave: Vec<usize> = (0..count).filter(|at| !is_convex(&previous, &next, *at)).collect();
    // Whether a corner is an ear changes only where a neighbour is clipped.
    let mut waiting: VecDeque<usize> = (0..count).collect();
    let mut waits = vec![true; count];
    let mut left = count;
    let mut last = 0;
    while left > 3
        && let Some(at) = waiting.pop_front()
    {
        waits[at] = false;
        let (before, after) = (previous[at], next[at]);
        let [a, b, c] = [before, at, after].map(|corner| points[corner]);
        let blocks = |other: &usize| {
            let p = points[*other];
            p != a && p != b && p != c && area(a, b, p) >= 0.0 && area(b, c, p) >= 0.0 && area(c, a, p) >= 0.0
        };
        if area(a, b, c) <= 0.0 || concave.iter().any(blocks) {
            continue;
        }
        push([before, at, after]);
        (next[before], previous[after]) = (after, before);
        (left, last) = (left - 1, after);
        waits[at] = true; // it never comes again
        for corner in [before, after] {
            if !std::mem::replace(&mut waits[corner], true) {
                waiting.push_back(corner);
            }
        }
        concave.retain(|corner| ![before, after].contains(corner) || !is_convex(&previous, &next, *corner));
    }
    while left > 2 {
        let at = next[last];
        push([last, at, next[at]]);
        next[last] = next[at];
        left -= 1;
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use glam::{DMat3, DQuat};

    use super::*;

    fn triangles(corners: &[DVec3]) -> Vec<[usize; 3]> {
        let mut triangles = Vec::new();
        triangulate(corners, |triangle| triangles.push(triangle)).unwrap();
        triangles
    }

    fn inside(polygon: &[DVec3], x: f64, y: f64) -> bool {
        let mut inside = false;
        for (a, b) in polygon.iter().zip(polygon.iter().cycle().skip(1)) {
            if (a.y > y) != (b.y > y) && x < (b.x - a.x) * (y - a.y) / (b.y - a.y) + a.x {
                inside = !inside;
            }
        }
        inside
    }

    /// Each triangle turns as the polygon does and its middle lies inside, and together they have its area; in every orientation, whichever
    /// corner is first.
    fn check(what: &str, flat: &[(f64, f64)], area: f64) {
        let flat: Vec<DVec3> = flat.iter().map(|(x, y)| DVec3::new(*x, *y, 0.0)).collect();
        for turn in 0..flat.len() {
            let mut flat = flat.clone();
            flat.rotate_left(turn);
            for map in [
                DMat3::IDENTITY,
                DMat3::from_rotation_x(1.8),
                DMat3::from_quat(DQuat::from_xyzw(0.3, -0.7, 0.2, 0.4).normalize()),
            ] {
                let corners: Vec<DVec3> =
                    flat.iter().map(|corner| map * *corner + DVec3::new(5.0, -3.0, 2.0)).collect();
                let normal = map * DVec3::Z;
                let found = triangles(&corners);
                assert_eq!(found.len(), corners.len() - 2, "{what}");
                let mut sum = 0.0;
                for triangle in &found {
                    let [a, b, c] = triangle.map(|corner| corners[corner]);
                    let signed = 0.5 * (b - a).cross(c - a).dot(normal);
                    assert!(signed >= -1e-12, "{what}: {triangle:?} is turned round");
                    sum += signed;
                    let middle = triangle.iter().map(|corner| flat[*corner]).sum::<DVec3>() / 3.0;
                    assert!(signed < 1e-9 || inside(&flat, middle.x, middle.y), "{what}: {triangle:?} is outside");
                }
                assert!((sum - area).abs() < 1e-9, "{what} from corner {turn}: area {sum}, and it is {area}");
            }
        }
    }

    #[test]
    fn triangles_fill_the_polygon_and_nothing_else() {
        check("square", &[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)], 1.0);
        check("dart", &[(0.0, 0.0), (2.0, -1.0), (0.5, 0.0), (2.0, 1.0)], 0.5);
        check(
            "U",
            &[(0.0, 0.0), (3.0, 0.0), (3.0, 3.0), (2.0, 3.0), (2.0, 1.0), (1.0, 1.0), (1.0, 3.0), (0.0, 3.0)],
            7.0,
        );
        check("corners on an edge", &[(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (0.0, 1.0)], 2.0);
        // A hole that a bridge joins to the rim: corners of the bridge lie on each other.
        let ring = [
            (0.0, 0.0),
            (3.0, 0.0),
            (3.0, 3.0),
            (0.0, 3.0),
            (0.0, 0.0),
            (1.0, 1.0),
            (1.0, 2.0),
            (2.0, 2.0),
            (2.0, 1.0),
            (1.0, 1.0),
        ];
        let ring: Vec<DVec3> = ring.iter().map(|(x, y)| DVec3::new(*x, *y, 0.0)).collect();
        let area: f64 = triangles(&ring)
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|corner| ring[corner]);
                0.5 * (b - a).cross(c - a).z.abs()
            })
            .sum();
        assert!((area - 8.0).abs() < 1e-12, "{area}");
        let star: Vec<(f64, f64)> = (0..40)
            .map(|corner| {
                let (sin, cos) = (std::f64::consts::TAU * f64::from(corner) / 40.0).sin_cos();
                let radius = if corner % 2 == 0 { 1.0 } else { 0.3 };
                (radius * cos, radius * sin)
            })
            .collect();
        check("star", &star, 20.0 * 0.3 * (std::f64::consts::TAU / 40.0).sin());
    }

    #[test]
    fn shapes_without_an_inside_end() {
        for count in [4, 5, 17, 400] {
            for value in [0.0, 1.0, f64::NAN, f64::INFINITY, 1e300] {
                let corner = |k: usize| DVec3::new((k * k % 7) as f64, (k * 5 % 11) as f64 * value, (k % 3) as f64);
                let corners: Vec<DVec3> = (0..count).map(corner).collect();
                let found = triangles(&corners);
                assert!(found.len() == count - 2 && found.iter().flatten().all(|corner| *corner < count));
            }
        }
        let zigzag: Vec<DVec3> = (0..MAX_CORNERS + 1).map(|k| DVec3::new(k as f64, (k * k % 7) as f64, 0.0)).collect();
        assert!(triangulate(&zigzag, |_| ()).unwrap_err().contains("8193 corners"));
    }
}
