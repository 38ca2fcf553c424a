//! The host's layout of every shared struct against what the shaders were compiled to.

use std::collections::{BTreeMap, BTreeSet};

use lumbre::layout::{self, INLINE_FIRST_ID, SharedStruct, address, specialisation};
use lumbre::techniques;

/// What was compiled: the name and the file of each module.
fn modules() -> impl Iterator<Item = (&'static str, &'static str)> {
    include_str!(concat!(env!("OUT_DIR"), "/modules.txt")).lines().filter_map(|line| line.split_once(' '))
}

const NAME: u32 = 5;
const MEMBER_NAME: u32 = 6;
const TYPE_ARRAY: u32 = 28;
const TYPE_RUNTIME_ARRAY: u32 = 29;
const DECORATE: u32 = 71;
const MEMBER_DECORATE: u32 = 72;
const SPEC_ID: u32 = 1;
const ARRAY_STRIDE: u32 = 6;
const OFFSET: u32 = 35;

/// Every shared struct, those of single families of techniques included.
fn structs() -> impl Iterator<Item = &'static SharedStruct> {
    layout::structs().chain(techniques::structs())
}

/// A module's instructions: the number of each, and its operands.
struct Module(Vec<(u32, Vec<u32>)>);

/// A module as it was compiled, with its names, which those in the program lack.
fn load(file: &str) -> Module {
    let bytes = std::fs::read(file).unwrap();
    let words: Vec<u32> = bytes.chunks_exact(4).map(|word| u32::from_ne_bytes(word.try_into().unwrap())).collect();
    let mut rest = &words[5..];
    let mut instructions = Vec::new();
    while let Some(first) = rest.first() {
        let (instruction, behind) = rest.split_at((first >> 16) as usize);
        instructions.push((first & 0xffff, instruction[1..].to_vec()));
        rest = behind;
    }
    Module(instructions)
}

/// The text that words hold, up to its zero byte.
fn text(words: &[u32]) -> String {
    let bytes = words.iter().flat_map(|word| word.to_le_bytes()).take_while(|byte| *byte != 0);
    String::from_utf8(bytes.collect()).unwrap()
}

impl Module {
    /// The operands of each instruction of a kind.
    fn of(&self, kind: u32) -> impl Iterator<Item = &[u32]> {
        self.0.iter().filter(move |(op, _)| *op == kind).map(|(_, operands)| &operands[..])
    }

    /// What identifiers are called.
    fn names(&self) -> BTreeMap<u32, String> {
        self.of(NAME).map(|operands| (operands[0], text(&operands[1..]))).collect()
    }

    /// Identifiers with the literal of a decoration of this kind.
    fn decorated(&self, kind: u32) -> BTreeMap<u32, u32> {
        self.of(DECORATE).filter(|operands| operands[1] == kind).map(|operands| (operands[0], operands[2])).collect()
    }

    /// Every struct that is laid out in memory: its name, and its members with their offsets.
    fn structs(&self) -> Vec<(String, Vec<(String, u32)>)> {
        let mut members: BTreeMap<u32, BTreeMap<u32, (String, Option<u32>)>> = BTreeMap::new();
        for operands in self.of(MEMBER_NAME) {
            members.entry(operands[0]).or_default().entry(operands[1]).or_default().0 = text(&operands[2..]);
        }
        for operands in self.of(MEMBER_DECORATE).filter(|operands| operands[2] == OFFSET) {
            members.entry(operands[0]).or_default().entry(operands[1]).or_default().1 = Some(operands[3]);
        }
        let names = self.names();
        let placed = members.into_iter().filter_map(|(id, members)| {
            // A struct that only local variables have is not in memory: its members have no offsets.
            let members: Option<Vec<_>> = members.into_values().map(|(name, offset)| Some((name, offset?))).collect();
            Some((names.get(&id)?.clone(), members?))
        });
        placed.collect()
    }
}

#[test]
fn offsets_are_the_same_on_both_sides() {
    let mut seen = BTreeSet::new();
    for (name, file) in modules() {
        for (found, members) in load(file).structs() {
            let Some(shared) = structs().find(|shared| shared.name == found) else { continue };
            let host: Vec<_> =
                shared.members.iter().map(|member| (member.name.to_owned(), member.offset as u32)).collect();
            assert_eq!(members, host, "{found} in {name}");
            seen.insert(shared.name);
        }
    }
    // `load_primitive` unpacks primitives by hand; see below.
    let all: BTreeSet<_> = structs().map(|shared| shared.name).filter(|name| *name != "Primitive").collect();
    assert_eq!(seen, all, "every shared struct is in memory in some module");
}

/// The words that `load_primitive` takes apart.
#[test]
fn primitives_are_ten_words() {
    let primitive = structs().find(|shared| shared.name == "Primitive").unwrap();
    let offsets: Vec<_> = primitive.members.iter().map(|member| (member.name, member.offset)).collect();
    assert_eq!(offsets, [("v0", 0), ("v1", 12), ("v2", 24), ("surface", 36)]);
    assert_eq!(primitive.size, 40);
}

#[test]
fn array_strides_are_the_sizes() {
    let mut checked = BTreeSet::new();
    for (name, file) in modules() {
        let module = load(file);
        let (names, strides) = (module.names(), module.decorated(ARRAY_STRIDE));
        for array in module.of(TYPE_RUNTIME_ARRAY).chain(module.of(TYPE_ARRAY)) {
            let element = names.get(&array[1]);
            let Some(shared) = structs().find(|shared| element.is_some_and(|name| name == shared.name)) else {
                continue;
            };
            if let Some(stride) = strides.get(&array[0]) {
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
    let mut found = BTreeMap::new();
    for (_, file) in modules() {
        let module = load(file);
        let names = module.names();
        let named = |(constant, id): (u32, u32)| Some((names.get(&constant)?.clone(), id));
        // Coordinates of the inline geometry have identifiers behind all others.
        found.extend(module.decorated(SPEC_ID).into_iter().filter(|(_, id)| *id < INLINE_FIRST_ID).filter_map(named));
    }
    let host: BTreeMap<_, _> = specialisation().map(|constant| (constant.name.to_owned(), constant.id)).collect();
    assert_eq!(found, host);
}

/// What `build.rs` writes for branches by kind names each kind of the tables once.
#[test]
fn every_kind_has_its_branches() {
    let materials = layout::materials_glsl();
    for kind in layout::MATERIALS {
        let Some(bsdf) = kind.bsdf else { continue };
        let delta = kind.has(layout::Trait::AllDelta);
        for (function, count) in [("sample", 1), ("eval", usize::from(!delta)), ("pdf", usize::from(!delta))] {
            let calls = materials.matches(&format!(" {}_{function}(", bsdf.prefix)).count();
            assert_eq!(calls, count, "calls of {}_{function}", bsdf.prefix);
        }
    }
    let lights = layout::lights_glsl();
    for kind in layout::LIGHTS {
        for function in ["sample", "emit"] {
            let calls = lights.matches(&format!(" {}_light_{function}(", kind.prefix)).count();
            assert_eq!(calls, 1, "calls of {}_light_{function}", kind.prefix);
        }
    }
}

#[test]
fn addresses_are_low_word_first() {
    assert_eq!(address(0x1122_3344_5566_7788), [0x5566_7788, 0x1122_3344]);
}
