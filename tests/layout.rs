//! The host's layout of every shared struct against what the shaders were compiled to.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::collections::{BTreeMap, BTreeSet};

use lumbre::layout::{self, SPECIALISATION, address};
use rspirv::dr::{Instruction, Module, Operand};
use rspirv::spirv::{Decoration, Op, Word};

const MODULES: [&str; 11] = [
    "test/mlt.bvh",
    "test/bdpt.bvh",
    "test/photon.bvh",
    "test/radiosity.bvh",
    "test/path.bvh",
    "test/path.ray-query",
    "test/trace.bvh",
    "test/bsdf.bvh",
    "test/light.bvh",
    "test/random.bvh",
    "rays/count.bvh",
];

fn load(name: &str) -> Module {
    let words: Vec<u32> = lumbre::gpu::module(name)
        .unwrap()
        .chunks_exact(4)
        .map(|word| u32::from_le_bytes(word.try_into().unwrap()))
        .collect();
    rspirv::dr::load_words(words).unwrap()
}

fn names(module: &Module) -> BTreeMap<Word, &str> {
    let named = module.debug_names.iter().filter(|instruction| instruction.class.opcode == Op::Name);
    named
        .map(|instruction| (instruction.operands[0].unwrap_id_ref(), instruction.operands[1].unwrap_literal_string()))
        .collect()
}

/// The literal of a decoration of this kind.
fn literal(instruction: &Instruction, kind: Decoration) -> Option<u32> {
    let at = instruction.operands.iter().position(|operand| *operand == Operand::Decoration(kind))?;
    Some(instruction.operands[at + 1].unwrap_literal_bit32())
}

/// Every struct that is laid out in memory: its name, and its members with their offsets.
fn structs(module: &Module) -> Vec<(String, Vec<(String, u32)>)> {
    let mut members: BTreeMap<Word, BTreeMap<u32, (String, Option<u32>)>> = BTreeMap::new();
    for instruction in &module.debug_names {
        if let [Operand::IdRef(id), Operand::LiteralBit32(index), Operand::LiteralString(name)] =
            &instruction.operands[..]
        {
            members.entry(*id).or_default().entry(*index).or_default().0.clone_from(name);
        }
    }
    for instruction in &module.annotations {
        if let (Op::MemberDecorate, Some(offset)) = (instruction.class.opcode, literal(instruction, Decoration::Offset))
        {
            let (id, index) = (instruction.operands[0].unwrap_id_ref(), instruction.operands[1].unwrap_literal_bit32());
            members.entry(id).or_default().entry(index).or_default().1 = Some(offset);
        }
    }
    let names = names(module);
    let placed = members.into_iter().filter_map(|(id, members)| {
        // A struct that only local variables have is not in memory: its members have no offsets.
        let members: Option<Vec<_>> = members.into_values().map(|(name, offset)| Some((name, offset?))).collect();
        Some((names.get(&id)?.to_string(), members?))
    });
    placed.collect()
}

#[test]
fn offsets_are_the_same_on_both_sides() {
    let mut seen = BTreeSet::new();
    for name in MODULES {
        for (found, members) in structs(&load(name)) {
            let Some(shared) = layout::structs().find(|shared| shared.name == found) else { continue };
            let host: Vec<_> =
                shared.members.iter().map(|member| (member.name.to_owned(), member.offset as u32)).collect();
            assert_eq!(members, host, "{found} in {name}");
            seen.insert(shared.name);
        }
    }
    // `load_primitive` unpacks primitives by hand; see below.
    let all: BTreeSet<_> = layout::structs().map(|shared| shared.name).filter(|name| *name != "Primitive").collect();
    assert_eq!(seen, all, "every shared struct is in memory in one of {MODULES:?}");
}

/// The words that `load_primitive` takes apart.
#[test]
fn primitives_are_ten_words() {
    let primitive = layout::structs().find(|shared| shared.name == "Primitive").unwrap();
    let offsets: Vec<_> = primitive.members.iter().map(|member| (member.name, member.offset)).collect();
    assert_eq!(offsets, [("v0", 0), ("v1", 12), ("v2", 24), ("surface", 36)]);
    assert_eq!(primitive.size, 40);
}

#[test]
fn array_strides_are_the_sizes() {
    let mut checked = BTreeSet::new();
    for name in MODULES {
        let module = load(name);
        let names = names(&module);
        let strides: BTreeMap<Word, u32> = module
            .annotations
            .iter()
            .filter_map(|instruction| {
                Some((instruction.operands[0].id_ref_any()?, literal(instruction, Decoration::ArrayStride)?))
            })
            .collect();
        for array in module
            .types_global_values
            .iter()
            .filter(|instruction| matches!(instruction.class.opcode, Op::TypeRuntimeArray | Op::TypeArray))
        {
            let element = names.get(&array.operands[0].unwrap_id_ref());
            let Some(shared) = layout::structs().find(|shared| element == Some(&shared.name)) else { continue };
            if let Some(stride) = strides.get(&array.result_id.unwrap()) {
                assert_eq!(*stride as usize, shared.size, "stride of an array of {} in {name}", shared.name);
                checked.insert(shared.name);
            }
        }
    }
    for name in ["Surface", "Material", "Light", "Instance", "FilmPixel", "RayRecord", "HitRecord", "TraversalCount"] {
        assert!(checked.contains(name), "no array of {name} was found");
    }
}

#[test]
fn specialisation_ids_are_the_same_on_both_sides() {
    let module = load("test/path.bvh");
    let names = names(&module);
    let mut checked = 0;
    for instruction in &module.annotations {
        let Some(id) = literal(instruction, Decoration::SpecId) else { continue };
        let name = names.get(&instruction.operands[0].unwrap_id_ref()).copied().unwrap_or_default();
        if let Some(constant) = SPECIALISATION.iter().find(|constant| constant.name == name) {
            assert_eq!(id, constant.id, "{name}");
            checked += 1;
        }
    }
    assert!(checked >= 20, "only {checked} specialisation constants were found");
}

#[test]
fn addresses_are_low_word_first() {
    assert_eq!(address(0x1122_3344_5566_7788), [0x5566_7788, 0x1122_3344]);
}
