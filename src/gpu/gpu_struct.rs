//! Writes one struct for both sides: a `Pod` Rust struct and the WGSL text with the same layout.
//!
//! A field whose WGSL offset would differ from its Rust offset does not compile, so nothing has to be "kept in sync".
//! The rules checked are those of the uniform address space, the stricter of the two (WGSL specification, section
//! "Address space layout constraints"), so that every struct serves in uniform and storage buffers alike.

/// Size and alignment in bytes of a WGSL host-shareable type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Bytes that a member of this type occupies.
    pub size: usize,
    /// Bytes its offset must be a multiple of.
    pub align: usize,
}

/// A Rust type with a WGSL twin of the same layout.
pub trait Wgsl {
    /// Layout of the WGSL twin.
    const LAYOUT: Layout;
    /// Whether the type is a struct or an array, which a uniform block places at multiples of 16 bytes.
    const IS_AGGREGATE: bool = false;
}

macro_rules! layouts {
    ($($T:ty: $size:literal, $align:literal;)*) => {
        $(impl Wgsl for $T { const LAYOUT: Layout = Layout { size: $size, align: $align }; })*
    };
}

layouts! {
    f32: 4, 4;
    i32: 4, 4;
    u32: 4, 4;
    glam::Vec2: 8, 8;
    glam::IVec2: 8, 8;
    glam::UVec2: 8, 8;
    glam::Vec3: 12, 16;
    glam::IVec3: 12, 16;
    glam::UVec3: 12, 16;
    glam::Vec4: 16, 16;
    glam::IVec4: 16, 16;
    glam::UVec4: 16, 16;
    glam::Mat4: 64, 16;
}

impl<T: Wgsl, const N: usize> Wgsl for [T; N] {
    const LAYOUT: Layout = {
        assert!(
            T::LAYOUT.size.is_multiple_of(16),
            "array elements of a uniform block are multiples of 16 bytes: use Vec4"
        );
        Layout { size: T::LAYOUT.size * N, align: T::LAYOUT.align }
    };
    const IS_AGGREGATE: bool = true;
}

/// `offset` rounded up to a multiple of `align`, both in bytes.
#[must_use]
pub const fn round_up(offset: usize, align: usize) -> usize {
    offset.div_ceil(align) * align
}

/// Declares structs shared with WGSL.
///
/// Fields are `f32`, `i32`, `u32`, `Vec2..4`, `IVec2..4`, `UVec2..4`, `Mat4`, another `gpu_struct!`, or `[T; N]` with a
/// literal `N` and a `T` whose size is a multiple of 16 bytes. Types are written by their bare name and must be in scope.
///
/// Each struct gets `NAME`, `WGSL` (its own declaration only; import the nested ones too) and `GENERATED`, the pair
/// that [`crate::shader::compose`] takes for `#import "generated/<NAME>.wgsl"`.
///
/// ```
/// use glam::{Vec3, Vec4};
/// nephoscope::gpu_struct! {
///     /// The sun.
///     pub struct Sun {
///         /// Unit vector.
///         pub towards_sun: Vec3,
///         /// In cd/m².
///         pub radiance: f32,
///         /// One per band.
///         pub bands: [Vec4; 2],
///     }
/// }
/// assert_eq!(Sun::WGSL, "struct Sun {\n  towards_sun: vec3f,\n  radiance: f32,\n  bands: array<vec4f, 2>,\n}\n");
/// ```
#[macro_export]
macro_rules! gpu_struct {
    ($($(#[$meta:meta])* $vis:vis struct $Name:ident {
        $($(#[$field_meta:meta])* $field_vis:vis $field:ident : $T:tt,)*
    })*) => { $(
        $(#[$meta])*
        #[repr(C)]
        #[derive(Clone, Copy, Debug, PartialEq, ::bytemuck::Pod, ::bytemuck::Zeroable)]
        $vis struct $Name { $($(#[$field_meta])* $field_vis $field: $T,)* }

        impl $Name {
            /// The struct's name in Rust and WGSL.
            $vis const NAME: &'static str = stringify!($Name);
            /// The same struct in WGSL, without the structs it contains.
            $vis const WGSL: &'static str = concat!(
                "struct ", stringify!($Name), " {\n",
                $("  ", stringify!($field), ": ", $crate::gpu_struct!(@wgsl $T), ",\n",)*
                "}\n"
            );
            /// Name and text, as the shader composer takes them.
            $vis const GENERATED: (&'static str, &'static str) = (Self::NAME, Self::WGSL);
        }

        impl $crate::gpu::gpu_struct::Wgsl for $Name {
            const LAYOUT: $crate::gpu::gpu_struct::Layout = {
                let mut end = 0;
                let mut align = 4;
                $(
                    let layout = <$T as $crate::gpu::gpu_struct::Wgsl>::LAYOUT;
                    let offset = $crate::gpu::gpu_struct::round_up(end, layout.align);
                    assert!(
                        ::std::mem::offset_of!($Name, $field) == offset,
                        concat!(stringify!($Name), ".", stringify!($field),
                            ": Rust and WGSL offsets differ; reorder the fields or add a pad before this one")
                    );
                    if <$T as $crate::gpu::gpu_struct::Wgsl>::IS_AGGREGATE {
                        assert!(
                            offset.is_multiple_of(16) && layout.size.is_multiple_of(16),
                            concat!(stringify!($Name), ".", stringify!($field),
                                ": a struct or array in a uniform block starts and ends at a multiple of 16 bytes")
                        );
                    }
                    end = offset + layout.size;
                    if layout.align > align { align = layout.align; }
                )*
                let size = $crate::gpu::gpu_struct::round_up(end, align);
                assert!(
                    ::std::mem::size_of::<$Name>() == size,
                    concat!(stringify!($Name), ": pad the end to WGSL's struct size")
                );
                $crate::gpu::gpu_struct::Layout { size, align }
            };
            const IS_AGGREGATE: bool = true;
        }
        const _: $crate::gpu::gpu_struct::Layout = <$Name as $crate::gpu::gpu_struct::Wgsl>::LAYOUT;
    )* };
    (@wgsl f32) => { "f32" };
    (@wgsl i32) => { "i32" };
    (@wgsl u32) => { "u32" };
    (@wgsl Vec2) => { "vec2f" };
    (@wgsl Vec3) => { "vec3f" };
    (@wgsl Vec4) => { "vec4f" };
    (@wgsl IVec2) => { "vec2i" };
    (@wgsl IVec3) => { "vec3i" };
    (@wgsl IVec4) => { "vec4i" };
    (@wgsl UVec2) => { "vec2u" };
    (@wgsl UVec3) => { "vec3u" };
    (@wgsl UVec4) => { "vec4u" };
    (@wgsl Mat4) => { "mat4x4f" };
    (@wgsl [$T:tt; $n:literal]) => { concat!("array<", $crate::gpu_struct!(@wgsl $T), ", ", $n, ">") };
    (@wgsl $Other:ident) => { stringify!($Other) };
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::mem::offset_of;

    use glam::{IVec2, IVec3, IVec4, Mat4, UVec2, UVec3, UVec4, Vec2, Vec3, Vec4};
    use wgpu::naga;

    gpu_struct! {
        /// Nested in the other.
        struct Inner {
            direction: Vec3,
            weight: f32,
            cell: IVec2,
            texel: UVec2,
        }

        /// One of everything.
        struct Outer {
            world_from_view: Mat4,
            inner: Inner,
            inners: [Inner; 3],
            bands: [Vec4; 2],
            position: Vec3,
            count: u32,
            cell: IVec3,
            step: i32,
            tile: UVec3,
            radius: f32,
            uv: Vec2,
            pad: Vec2,
            low: IVec4,
            high: UVec4,
        }
    }

    macro_rules! offsets {
        ($Name:ident: $($field:ident)*) => { [$((stringify!($field), offset_of!($Name, $field)),)*] };
    }

    fn assert_same(module: &naga::Module, name: &str, offsets: &[(&str, usize)], size: usize) {
        let (_, found) = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name)).unwrap();
        let naga::TypeInner::Struct { members, span } = &found.inner else { panic!("{name} is not a struct") };
        let theirs: Vec<(&str, usize)> =
            members.iter().map(|m| (m.name.as_deref().unwrap(), m.offset as usize)).collect();
        assert_eq!(theirs, offsets, "naga's offsets of {name}");
        assert_eq!(*span as usize, size, "naga's size of {name}");
    }

    #[test]
    fn naga_computes_the_same_offsets_and_accepts_the_struct_as_uniform() {
        let main = "#import \"generated/Outer.wgsl\"\n#import \"generated/Inner.wgsl\"\n\
            @group(0) @binding(0) var<uniform> outer: Outer;\n\
            @compute @workgroup_size(1) fn main() { _ = outer; }\n";
        let read = |_: &str| Ok(Some(main.into()));
        let generated = [Inner::GENERATED, Outer::GENERATED];
        let source = crate::shader::compose_with(&read, "main.wgsl", &BTreeSet::new(), &[], &generated).unwrap();
        let (module, _) = crate::shader::validate(&source).unwrap();
        assert_same(&module, Inner::NAME, &offsets!(Inner: direction weight cell texel), size_of::<Inner>());
        let outer =
            offsets!(Outer: world_from_view inner inners bands position count cell step tile radius uv pad low high);
        assert_same(&module, Outer::NAME, &outer, size_of::<Outer>());
    }
}
