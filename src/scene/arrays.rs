//! The arrays of a scene on their way to a device, by the list in `layout`.

use super::{Needs, Scene};
use crate::layout::{SceneUniforms, scene_arrays, uvec2};

/// An array of a scene as a device holds it.
#[derive(Clone, Copy, Debug)]
pub struct DeviceArray<'a> {
    /// Its name in reports of memory.
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
                    name: $name,
                    bytes: if device_arrays!(@needed needs $($need)?) { bytemuck::cast_slice(&self.$field) } else { &[] },
                    address: |uniforms| &mut uniforms.$field,
                } ),*]
            }

            /// The arrays that are uploaded in another order or with addresses in them; their sizes are those on the device.
            pub fn changed_arrays(&self) -> Vec<DeviceArray<'_>> {
                vec![$( DeviceArray {
                    name: $other_name,
                    bytes: bytemuck::cast_slice(&self.$other),
                    address: |uniforms| &mut uniforms.$other,
                } ),*]
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
