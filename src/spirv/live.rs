//! What of the blocks that can be reached has any effect, and the globals that it needs.

use std::collections::HashMap;

use super::fold::{Known, Scalar};
use super::module::Instruction;
use super::op;
use super::propagate::{Block, NONE, Propagation};

/// What a specialised module keeps.
pub struct Live<'a> {
    /// What was found out about the module.
    pub found: &'a Propagation<'a>,
    /// Per instruction, whether it stays. Labels and terminators of blocks that are reached stay with their function.
    pub instructions: Vec<bool>,
    /// Per function, whether it stays.
    pub functions: Vec<bool>,
    /// Constants that the module does not have yet, with their identifiers.
    pub new_constants: Vec<(u32, Scalar)>,
    /// The first identifier that is free after those.
    pub bound: u32,
    constants: HashMap<Scalar, u32>,
    /// Per identifier of a local variable, whether something reads it, and the stores that nobody has asked for yet.
    is_read: Vec<bool>,
    stores: HashMap<u32, Vec<u32>>,
    has_effects: Vec<bool>,
    queue: Vec<u32>,
}

impl<'a> Live<'a> {
    /// Marks all that the entry point needs.
    pub fn find(found: &'a Propagation<'a>) -> Self {
        let module = found.module;
        let mut new = Self {
            found,
            instructions: vec![false; module.code.len()],
            functions: vec![false; found.functions.len()],
            new_constants: Vec::new(),
            bound: module.bound,
            constants: HashMap::new(),
            is_read: vec![false; module.bound as usize],
            stores: HashMap::new(),
            has_effects: vec![false; found.functions.len()],
            queue: Vec::new(),
        };
        for instruction in module.code.iter().take_while(|instruction| instruction.op != op::FUNCTION) {
            if let (Some(id), op::CONSTANT_TRUE | op::CONSTANT_FALSE | op::CONSTANT) =
                (module.result(*instruction), instruction.op)
                && let Known::Constant(scalar) = found.known[id as usize]
            {
                new.constants.entry(scalar).or_insert(id);
            }
        }
        new.find_effects();
        for (index, instruction) in module.code.iter().enumerate() {
            match instruction.op {
                op::CAPABILITY | op::EXTENSION | op::EXT_INST_IMPORT | op::MEMORY_MODEL | op::EXECUTION_MODE => {
                    new.instructions[index] = true
                }
                op::EXECUTION_MODE_ID => new.mark(index as u32),
                op::ENTRY_POINT => {
                    new.instructions[index] = true;
                    found
                        .function_of(module.operands(*instruction)[1])
                        .into_iter()
                        .for_each(|main| new.keep_function(main));
                }
                op::DECORATE if module.operands(*instruction)[1..] == op::WORKGROUP_SIZE => {
                    new.need(module.operands(*instruction)[0]);
                }
                _ => {}
            }
        }
        new.settle();
        new
    }

    /// Whether the instruction at this index is in a block that is reached.
    fn is_reached(&self, block: u32) -> bool {
        self.found.reached[block as usize]
    }

    /// A function has effects where something in it reaches beyond its own variables.
    fn find_effects(&mut self) {
        let found = self.found;
        let module = found.module;
        loop {
            let mut changed = false;
            for (index, function) in found.functions.iter().enumerate() {
                let blocks = function.blocks.clone().filter(|block| self.is_reached(*block));
                let mut code = blocks.flat_map(|block| {
                    let Block { first, last, .. } = found.blocks[block as usize];
                    &module.code[first as usize + 1..=last as usize]
                });
                let has_effects = self.has_effects[index]
                    || code.any(|instruction| match instruction.op {
                        op::STORE => !found.is_local(found.root(module.operands(*instruction)[0])),
                        op::FUNCTION_CALL => self.call_has_effects(*instruction),
                        _ => !op::is_pure(instruction.op),
                    });
                changed |= has_effects != self.has_effects[index];
                self.has_effects[index] = has_effects;
            }
            if !changed {
                return;
            }
        }
    }

    fn call_has_effects(&self, instruction: Instruction) -> bool {
        let callee = self.found.function_of(self.found.module.operands(instruction)[0]);
        callee.is_none_or(|callee| self.has_effects[callee])
    }

    fn keep_function(&mut self, function: usize) {
        if std::mem::replace(&mut self.functions[function], true) {
            return;
        }
        let found = self.found;
        let module = found.module;
        let first = found.functions[function].first;
        self.mark(first);
        for parameter in &found.functions[function].parameters {
            self.mark(*parameter);
        }
        for block in found.functions[function].blocks.clone().filter(|block| found.reached[*block as usize]) {
            let Block { first, last, .. } = found.blocks[block as usize];
            for index in first + 1..last {
                let instruction = module.code[index as usize];
                match instruction.op {
                    op::STORE => {
                        let root = found.root(module.operands(instruction)[0]);
                        if !found.is_local(root) || self.is_read[root as usize] {
                            self.mark(index);
                        } else {
                            self.stores.entry(root).or_default().push(index);
                        }
                    }
                    op::FUNCTION_CALL if self.call_has_effects(instruction) => self.mark(index),
                    op::FUNCTION_CALL | op::LOOP_MERGE | op::SELECTION_MERGE => {}
                    _ if op::is_pure(instruction.op) => {}
                    _ => self.mark(index),
                }
            }
            let end = module.code[last as usize];
            match end.op {
                op::RETURN_VALUE => self.need(module.operands(end)[0]),
                // The number stays where the way to go is known, as a `switch` with one case.
                op::SWITCH => self.need(module.operands(end)[0]),
                op::BRANCH_CONDITIONAL if found.branch_taken(last).is_none() => self.need(module.operands(end)[0]),
                _ => {}
            }
        }
    }

    fn mark(&mut self, index: u32) {
        if !std::mem::replace(&mut self.instructions[index as usize], true) {
            self.queue.push(index);
        }
    }

    /// The identifier that stands for this one: of a constant, or of the only value that a phi or a selection can have.
    pub fn resolve(&self, mut id: u32) -> u32 {
        // Phis that have only each other as values can stand in broken modules: there is an end to asking.
        for _ in 0..=self.found.module.code.len() {
            let index = self.found.definition[id as usize];
            let instruction = self.found.module.code[index as usize];
            let is_instruction =
                index > self.found.functions[0].first && !matches!(instruction.op, op::FUNCTION | op::LABEL);
            if !is_instruction {
                return id;
            }
            if let Known::Constant(scalar) = self.found.known[id as usize] {
                return self.constants.get(&scalar).copied().unwrap_or(id);
            }
            let chosen = match instruction.op {
                op::SELECT => {
                    let operands = self.found.module.operands(instruction);
                    self.found.known[operands[0] as usize].bits().map(|bits| operands[if bits == 1 { 1 } else { 2 }])
                }
                _ => match self.incoming(index)[..] {
                    [(only, _)] => Some(only),
                    _ => None,
                },
            };
            match chosen {
                Some(other) => id = other,
                None => return id,
            }
        }
        id
    }

    /// Of a phi, the values that can arrive with the labels that they come from; nothing for other instructions.
    pub fn incoming(&self, index: u32) -> Vec<(u32, u32)> {
        let found = self.found;
        let instruction = found.module.code[index as usize];
        if instruction.op != op::PHI {
            return Vec::new();
        }
        let block = found.block_at_index(index);
        let pairs = found.module.operands(instruction).chunks_exact(2).map(|pair| (pair[0], pair[1]));
        pairs.filter(|(_, label)| found.edges.contains(&(found.block_at(*label), block))).collect()
    }

    /// Something that stays refers to this.
    fn need(&mut self, id: u32) {
        let index = self.found.definition[id as usize];
        let is_instruction = index > self.found.functions[0].first;
        if is_instruction
            && let Known::Constant(scalar) = self.found.known[id as usize]
            && !self.constants.contains_key(&scalar)
        {
            self.constants.insert(scalar, self.bound);
            self.new_constants.push((self.bound, scalar));
            self.bound += 1;
            self.need(scalar.ty);
        }
        let id = self.resolve(id);
        if id >= self.found.module.bound {
            return;
        }
        let index = self.found.definition[id as usize];
        match self.found.module.code[index as usize].op {
            op::LABEL => {}
            op::FUNCTION => {
                self.found.function_of(id).into_iter().for_each(|function| self.keep_function(function));
            }
            _ => self.mark(index),
        }
    }

    fn settle(&mut self) {
        let found = self.found;
        let module = found.module;
        while let Some(index) = self.queue.pop() {
            let instruction = module.code[index as usize];
            if instruction.op == op::PHI {
                module.result_type(instruction).into_iter().for_each(|ty| self.need(ty));
                self.incoming(index).into_iter().for_each(|(value, _)| self.need(value));
                continue;
            }
            let is_in_function = found.block_at_index(index) != NONE;
            for (place, id) in module.ids(instruction).enumerate() {
                self.need(id);
                // Whoever has a pointer may read, but for one who stores there, or goes on to a part.
                let passes_on =
                    matches!(instruction.op, op::ACCESS_CHAIN | op::IN_BOUNDS_ACCESS_CHAIN | op::COPY_OBJECT);
                let stores = instruction.op == op::STORE && place == 0;
                if is_in_function && !passes_on && !stores && found.definition[id as usize] != NONE {
                    let root = found.root(id);
                    if found.is_local(root) && !std::mem::replace(&mut self.is_read[root as usize], true) {
                        self.stores.remove(&root).into_iter().flatten().for_each(|store| self.mark(store));
                    }
                }
            }
        }
    }
}
