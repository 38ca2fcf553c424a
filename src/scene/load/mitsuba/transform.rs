//! `<transform>`: a list of maps, the first of which is applied first.

use glam::{DAffine3, DMat3, DVec3};

use super::document::Element;
use super::numbers::{number, numbers, vector};
use super::object::Warnings;
use crate::error::Result;
use crate::scene::camera;

/// The product of a transform's parts.
pub(super) fn parse(element: &Element, warnings: &Warnings) -> Result<DAffine3> {
    let mut total = DAffine3::IDENTITY;
    for part in &element.children {
        if part.tag == "rotate" && (vector(part, 0.0)?.length() - 1.0).abs() > 1e-3 {
            let warning = "the axis of <rotate> is no unit vector: it stretches as well, as in Mitsuba";
            warnings.borrow_mut().push(format!("{}:{}: {warning}", part.file.path.display(), part.line));
        }
        total = parse_part(part)? * total;
    }
    let determinant = total.matrix3.determinant();
    if !total.is_finite() || determinant == 0.0 {
        return Err(element.error("the transform is singular: it must be invertible, with finite numbers"));
    }
    Ok(total)
}

/// Rodrigues' formula, a rotation around a unit vector. As Mitsuba does, it takes another vector as it is, and stretches.
fn rotation(axis: DVec3, angle: f64) -> DMat3 {
    let (sine, cosine) = angle.sin_cos();
    let cross = DMat3::from_cols(axis.cross(DVec3::X), axis.cross(DVec3::Y), axis.cross(DVec3::Z));
    let outer = DMat3::from_cols(axis * axis.x, axis * axis.y, axis * axis.z);
    DMat3::from_diagonal(DVec3::splat(cosine)) + cross * sine + outer * (1.0 - cosine)
}

fn parse_part(part: &Element) -> Result<DAffine3> {
    let point = |name: &str| {
        let text = part.attribute(name)?;
        match numbers(text).as_deref() {
            Some([x, y, z]) => Ok(DVec3::new(*x, *y, *z)),
            _ => Err(part.error(format!("<{}> '{name}': '{text}' is not three numbers", part.tag))),
        }
    };
    match part.tag.as_str() {
        "translate" => Ok(DAffine3::from_translation(vector(part, 0.0)?)),
        "scale" => Ok(DAffine3::from_scale(vector(part, 1.0)?)),
        "rotate" => {
            let text = part.attribute("angle")?;
            let angle =
                number(text).ok_or_else(|| part.error(format!("<rotate> 'angle': '{text}' is not a number")))?;
            let axis = vector(part, 0.0)?;
            if axis == DVec3::ZERO {
                return Err(part.error("<rotate> needs an axis: x, y or z other than 0"));
            }
            Ok(DAffine3::from_mat3(rotation(axis, angle.to_radians())))
        }
        "lookat" | "lookAt" => {
            let (origin, target) = (point("origin")?, point("target")?);
            let up = if part.attributes.contains_key("up") {
                point("up")?
            } else {
                (target - origin).any_orthogonal_vector()
            };
            camera::look_at(origin, target, up).ok_or_else(|| {
                part.error("<lookat>: origin and target must differ, and up must not be parallel to their difference")
            })
        }
        "matrix" => {
            let text = part.attribute("value")?;
            match numbers(text).as_deref() {
                Some([a, b, c, x, d, e, f, y, g, h, i, z, 0.0, 0.0, 0.0, 1.0]) => Ok(DAffine3 {
                    matrix3: DMat3::from_cols_array(&[*a, *d, *g, *b, *e, *h, *c, *f, *i]),
                    translation: DVec3::new(*x, *y, *z),
                }),
                Some([a, b, c, d, e, f, g, h, i]) => {
                    Ok(DAffine3::from_mat3(DMat3::from_cols_array(&[*a, *d, *g, *b, *e, *h, *c, *f, *i])))
                }
                Some(list) if list.len() == 16 => Err(part.error("<matrix>: the last row must be 0 0 0 1")),
                _ => Err(part.error("<matrix> 'value' must be 9 or 16 numbers, row by row")),
            }
        }
        tag => Err(part
            .error(format!("<{tag}> is not a transform; supported are translate, scale, rotate, lookat and matrix"))),
    }
}
