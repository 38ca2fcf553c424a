//! The arrays of a scene on their way to a device, by the list in `layout`.

use super::{Needs, Scene};
use crate::layout::{ARRAY_NAMES, SceneUniforms, scene_arrays, uvec2};

/// An array of a scene as a device holds it.
#[derive(Clone, Copy, Debug)]
pub struct DeviceArray<'a> {
    /// The array's name in reports of memory.
    pub name: &'static str,
    /// Its bytes; none where no kernel of the scene reads it.
    pub bytes: &'a [u8],
    /// The place of its device address.
    pub address: fn(&mut SceneUniforms) -> &mut uvec2,
}

macro_rules! device_arrays {
    (
        whole { $( $(#[$doc:meta])* $field:ident : $kind:ident in $buffer:ident, $name:literal $(if $need:ident)?; )* }
        changed { $( $(#[$other_doc:meta])* $other:ident : $other_kind:ident $(in $other_buffer:ident)?, $other_name:literal; )* }
        made { $($made:tt)* }
    ) => {
        impl Scene {
            /// The arrays that are uploaded as they are.
            pub fn arrays(&self, needs: &Needs) -> Vec<DeviceArray<'_>> {
                vec![$( DeviceArray {
                    name: ARRAY_NAMES.$field,
                    bytes: if device_arrays!(@needed needs $($need)?) { bytemuck::cast_slice(&self.$field) } else { &[] },
                    address: |uniforms| &mut uniforms.$field,
                } ),*]
            }

            /// The arrays that are uploaded in another order or with addresses in them; their names and their bytes, as
            /// many as on the device.
            pub fn changed_arrays(&self) -> Vec<(&'static str, &[u8])> {
                vec![$( (ARRAY_NAMES.$other, bytemuck::cast_slice(&self.$other)) ),*]
            }
        }
    };
    (@needed $needs:ident) => {
        true
    };
    (@needed $needs:ident $need:ident) => {
        $needs.$need
    };
}
scene_arrays!(device_arrays);
