//! Writes the module that is left.

use super::live::Live;
use super::module::{HEADER, Instruction};
use super::op;
use super::propagate::{Block, Propagation};

/// How a driver may treat arithmetic on floats.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Arithmetic {
    /// It may regroup sums and products, as SPIR-V allows by itself: faster, and the last bits follow how code is put together.
    #[default]
    Free,
    /// As it is written, each result decorated `NoContraction`: the last bits follow the shader's text alone.
    Exact,
}

/// Writes words, with identifiers numbered in the order of their first use.
struct Writer<'a, 'b> {
    live: &'b Live<'a>,
    found: &'a Propagation<'a>,
    words: Vec<u32>,
    numbers: Vec<u32>,
    next: u32,
    count: usize,
}

/// The words of the module that is left, and its number of instructions.
pub fn emit(live: &Live, arithmetic: Arithmetic) -> (Vec<u32>, usize) {
    let module = live.found.module;
    let mut writer = Writer {
        live,
        found: live.found,
        words: module.words[..HEADER].to_vec(),
        numbers: vec![0; live.bound as usize],
        next: 1,
        count: 0,
    };
    let is_global = |instruction: &&Instruction| instruction.op != op::FUNCTION;
    let mut decorated = false;
    for (index, instruction) in (0u32..).zip(module.code.iter().take_while(is_global)) {
        // Decorations end where types begin.
        if arithmetic == Arithmetic::Exact
            && !decorated
            && (op::TYPE_VOID..=op::TYPE_FUNCTION).contains(&instruction.op)
        {
            writer.decorate_arithmetic();
            decorated = true;
        }
        writer.global(index, *instruction);
    }
    for (id, scalar) in &live.new_constants {
        writer.constant(*id, scalar.ty, scalar.bits);
    }
    let kept = live.found.functions.iter().zip(&live.functions).filter(|(_, kept)| **kept);
    for (function, _) in kept {
        writer.copy(module.code[function.first as usize]);
        function.parameters.iter().for_each(|parameter| writer.copy(module.code[*parameter as usize]));
        writer.blocks(function.blocks.clone());
        writer.write(op::FUNCTION_END, &[]);
    }
    writer.words[3] = writer.next;
    (writer.words, writer.count)
}

impl Writer<'_, '_> {
    fn write(&mut self, number: u16, operands: &[u32]) {
        self.words.push(u32::from(number) | (operands.len() as u32 + 1) << 16);
        self.words.extend_from_slice(operands);
        self.count += 1;
    }

    /// The new number of an identifier.
    fn number(&mut self, id: u32) -> u32 {
        let number = &mut self.numbers[id as usize];
        if *number == 0 {
            *number = self.next;
            self.next += 1;
        }
        *number
    }

    /// The new number of what stands for an identifier.
    fn value(&mut self, id: u32) -> u32 {
        let id = self.live.resolve(id);
        self.number(id)
    }

    /// Decorates the results of arithmetic that stays.
    fn decorate_arithmetic(&mut self) {
        for (index, instruction) in (0u32..).zip(&self.found.module.code) {
            if op::is_arithmetic(instruction.op) && self.live.instructions[index as usize] {
                let id = self.found.module.result(*instruction).map_or(0, |id| self.number(id));
                self.write(op::DECORATE, &[id, op::NO_CONTRACTION]);
            }
        }
    }

    /// An instruction as it is, with new numbers.
    fn copy(&mut self, instruction: Instruction) {
        let module = self.found.module;
        let start = self.words.len();
        self.words.extend_from_slice(module.words_of(instruction));
        for place in instruction.id_places(module.words) {
            self.words[start + place - instruction.at as usize] = self.value(module.words[place]);
        }
        if let Some(place) = instruction.result_place() {
            self.words[start + place - instruction.at as usize] = self.number(module.words[place]);
        }
        self.count += 1;
    }

    fn constant(&mut self, id: u32, ty: u32, bits: u64) {
        let (id, numbered) = (self.number(id), self.number(ty));
        let ty = self.found.module.code[self.found.definition[ty as usize] as usize];
        match ty.op {
            op::TYPE_BOOL => {
                self.write(if bits == 0 { op::CONSTANT_FALSE } else { op::CONSTANT_TRUE }, &[numbered, id])
            }
            _ if self.found.module.operands(ty)[0] > 32 => {
                self.write(op::CONSTANT, &[numbered, id, bits as u32, (bits >> 32) as u32]);
            }
            _ => self.write(op::CONSTANT, &[numbered, id, bits as u32]),
        }
    }

    /// An instruction before the functions.
    fn global(&mut self, index: u32, instruction: Instruction) {
        let module = self.found.module;
        let operands = module.operands(instruction);
        let is_live = |id: u32| self.live.instructions[self.found.definition[id as usize] as usize];
        match instruction.op {
            op::DECORATE | op::MEMBER_DECORATE | op::TYPE_FORWARD_POINTER => {
                // A constant that is not to be chosen any more has no `constant_id`.
                let is_choice = instruction.op == op::DECORATE && operands.get(1) == Some(&op::SPEC_ID);
                if is_live(operands[0]) && !is_choice {
                    self.copy(instruction);
                }
            }
            op::ENTRY_POINT => {
                // Of the variables it names those that are left.
                let all: Vec<u32> = module.ids(instruction).skip(1).collect();
                let kept: Vec<u32> = all.iter().copied().filter(|id| is_live(*id)).collect();
                let name = &operands[2..operands.len() - all.len()];
                let mut new = vec![operands[0], self.number(operands[1])];
                new.extend_from_slice(name);
                for id in kept {
                    new.push(self.number(id));
                }
                self.write(op::ENTRY_POINT, &new);
            }
            _ if !self.live.instructions[index as usize] => {}
            op::SPEC_CONSTANT_TRUE | op::SPEC_CONSTANT_FALSE | op::SPEC_CONSTANT | op::SPEC_CONSTANT_OP => {
                let id = instruction.result_place().map_or(0, |place| module.words[place]);
                match (self.found.known[id as usize].bits(), module.result_type(instruction)) {
                    (Some(bits), Some(ty)) => self.constant(id, ty, bits),
                    _ => self.copy(instruction),
                }
            }
            // Its parts may still be operations that only a driver evaluates.
            op::SPEC_CONSTANT_COMPOSITE => {
                let start = self.words.len();
                let are_plain = operands.iter().all(|part| self.is_plain(*part));
                self.copy(instruction);
                if are_plain {
                    self.words[start] = self.words[start] & 0xffff_0000 | u32::from(op::CONSTANT_COMPOSITE);
                }
            }
            _ => self.copy(instruction),
        }
    }

    /// Whether a constant depends on no operation that is left to the driver.
    fn is_plain(&self, id: u32) -> bool {
        let module = self.found.module;
        let instruction = module.code[self.found.definition[id as usize] as usize];
        match instruction.op {
            op::SPEC_CONSTANT_OP => self.found.known[id as usize].bits().is_some(),
            op::SPEC_CONSTANT_COMPOSITE => module.operands(instruction).iter().all(|part| self.is_plain(*part)),
            _ => true,
        }
    }

    fn blocks(&mut self, blocks: std::ops::Range<u32>) {
        let found = self.found;
        // Every merge names two blocks or one that have to be there, even where nothing leads to them any more.
        let mut stubs = vec![None; blocks.len()];
        for block in blocks.clone().filter(|block| found.reached[*block as usize]) {
            if let Some(index) = self.kept_merge(block) {
                let operands = found.module.operands(found.module.code[index as usize]);
                let mut stub = |label: u32, back_to: Option<u32>| {
                    let target = found.block_at(label);
                    if !found.reached[target as usize] {
                        stubs[(target - blocks.start) as usize] = Some(back_to);
                    }
                };
                stub(operands[0], None);
                if found.module.code[index as usize].op == op::LOOP_MERGE {
                    stub(operands[1], Some(self.label(block)));
                }
            }
        }
        for block in blocks.clone() {
            if found.reached[block as usize] {
                self.block(block, blocks.start, &stubs);
            } else if let Some(back_to) = stubs[(block - blocks.start) as usize] {
                let label = self.label(block);
                let label = self.number(label);
                self.write(op::LABEL, &[label]);
                match back_to {
                    Some(header) => {
                        let header = self.number(header);
                        self.write(op::BRANCH, &[header]);
                    }
                    None => self.write(op::UNREACHABLE, &[]),
                }
            }
        }
    }

    /// Where a branch goes, if that is known.
    fn taken(&self, index: u32) -> Option<u32> {
        let is_branch = matches!(self.found.module.code[index as usize].op, op::BRANCH_CONDITIONAL | op::SWITCH);
        is_branch.then(|| self.found.branch_taken(index)).flatten()
    }

    fn label(&self, block: u32) -> u32 {
        let label = self.found.module.code[self.found.blocks[block as usize].first as usize];
        self.found.module.result(label).unwrap_or(0)
    }

    /// The merge of a block, unless the branch behind it has become a plain one.
    fn kept_merge(&self, block: u32) -> Option<u32> {
        let Block { first, last, .. } = self.found.blocks[block as usize];
        let index = last.checked_sub(1).filter(|index| *index > first)?;
        let code = &self.found.module.code;
        match code[index as usize].op {
            op::LOOP_MERGE => Some(index),
            op::SELECTION_MERGE if code[last as usize].op == op::SWITCH || self.taken(last).is_none() => Some(index),
            _ => None,
        }
    }

    fn block(&mut self, block: u32, first_block: u32, stubs: &[Option<Option<u32>>]) {
        let found = self.found;
        let module = found.module;
        let Block { first, last, .. } = found.blocks[block as usize];
        self.copy(module.code[first as usize]);
        let merge = self.kept_merge(block);
        let continues = merge.map(|index| module.code[index as usize]).filter(|merge| merge.op == op::LOOP_MERGE);
        let stub = continues.map(|merge| module.operands(merge)[1]).filter(|label| {
            let target = found.block_at(*label);
            stubs[(target - first_block) as usize].is_some()
        });
        for index in first + 1..last {
            let instruction = module.code[index as usize];
            if instruction.op == op::PHI && self.live.instructions[index as usize] {
                self.phi(index, instruction, stub);
            } else if self.live.instructions[index as usize] {
                self.copy(instruction);
            }
        }
        if let Some(merge) = merge {
            self.copy(module.code[merge as usize]);
        }
        let end = module.code[last as usize];
        match self.taken(last) {
            Some(label) if end.op == op::SWITCH => {
                let (selector, label) = (self.value(module.operands(end)[0]), self.number(label));
                self.write(op::SWITCH, &[selector, label]);
            }
            Some(label) => {
                let label = self.number(label);
                self.write(op::BRANCH, &[label]);
            }
            None => self.copy(end),
        }
    }

    /// A choice between the values that can still arrive; `stub` is where a loop goes back from that is never gone round.
    fn phi(&mut self, index: u32, instruction: Instruction, stub: Option<u32>) {
        let module = self.found.module;
        let ty = self.number(module.result_type(instruction).unwrap_or(0));
        let result = self.number(module.result(instruction).unwrap_or(0));
        let mut operands = vec![ty, result];
        let incoming = self.live.incoming(index);
        for (value, label) in &incoming {
            operands.push(self.value(*value));
            operands.push(self.number(*label));
        }
        if let (Some(label), Some((value, _))) = (stub, incoming.first()) {
            operands.push(self.value(*value));
            operands.push(self.number(label));
        }
        self.write(op::PHI, &operands);
    }
}
