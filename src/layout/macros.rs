//! The macro that declares a struct on both sides at once.

macro_rules! shared_structs {
    ($(
        $(#[$doc:meta])*
        pub struct $name:ident { $( $(#[$member_doc:meta])* $member:ident : $kind:ident ),* $(,)? }
    )*) => {
        $(
            $(#[$doc])*
            #[repr(C)]
            #[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
            pub struct $name { $( $(#[$member_doc])* pub $member: $kind ),* }
            const _: () = assert!(align_of::<$name>() == 4, "a shared struct has alignment 4");
        )*

        /// The shared structs of this module, in the order of declaration.
        pub(crate) const STRUCTS: &[SharedStruct] = &[$(
            SharedStruct {
                name: stringify!($name),
                size: size_of::<$name>(),
                members: &[$( Member { name: stringify!($member), offset: std::mem::offset_of!($name, $member) } ),*],
                glsl: concat!(
                    "struct ", stringify!($name), " {\n",
                    $( "    ", stringify!($kind), " ", stringify!($member), ";\n", )*
                    "};\n"
                ),
            },
        )*];
    };
}
pub(crate) use shared_structs;
