//! Which values of a module are constant once its specialisation constants are, and which blocks can be reached then.
//!
//! Sparse conditional constant propagation (Wegman and Zadeck 1991, "Constant propagation with conditional branches", ACM TOPLAS 13(2)),
//! over the whole module at once: a function's parameters have what all calls that are reached give them. Local variables that are
//! only loaded and stored count as values, too: what a load sees is one of the stores that are reached.

use std::collections::HashSet;

use super::fold::{self, Known, Scalar};
use super::module::{Instruction, Module};
use super::op;

/// No index.
pub const NONE: u32 = u32::MAX;

/// A block: indices of its label and its terminator.
#[derive(Clone, Copy, Debug)]
pub struct Block {
    /// Its label.
    pub first: u32,
    /// Its terminator.
    pub last: u32,
    /// Its function.
    pub function: u32,
}

/// A function.
#[derive(Clone, Debug, Default)]
pub struct Function {
    /// Index of its `OpFunction`.
    pub first: u32,
    /// Indices of its `OpFunctionParameter`s.
    pub parameters: Vec<u32>,
    /// Its blocks, the entry first.
    pub blocks: std::ops::Range<u32>,
    returned: Option<Known>,
    calls: Vec<u32>,
}

/// A module's structure, and what was found out about it.
pub struct Propagation<'a> {
    /// The module.
    pub module: &'a Module<'a>,
    /// Per identifier, the index of the instruction that defines it.
    pub definition: Vec<u32>,
    /// Per identifier, what is known of its value.
    pub known: Vec<Known>,
    /// All blocks, in order.
    pub blocks: Vec<Block>,
    /// Per block, whether it can be reached.
    pub reached: Vec<bool>,
    /// All functions, in order.
    pub functions: Vec<Function>,
    /// Pairs of blocks of which the second can follow the first.
    pub edges: HashSet<(u32, u32)>,
    /// Per identifier of a type, bits of a scalar of it; 0 where it is no scalar.
    widths: Vec<u32>,
    /// Per identifier of a local variable or a pointer parameter: whether it counts as a value, and what was stored there.
    is_cell: Vec<bool>,
    cells: Vec<Known>,
    users: Vec<Vec<u32>>,
    /// Per instruction, its block.
    block_of: Vec<u32>,
    block_queue: Vec<u32>,
    queue: Vec<u32>,
}

impl<'a> Propagation<'a> {
    /// Propagates from the entry point, with these values of specialisation constants: pairs of `constant_id` and bits.
    pub fn run(module: &'a Module<'a>, constants: &[(u32, u32)]) -> Result<Self, String> {
        let mut new = Self::structure(module)?;
        new.find_cells();
        new.globals(constants);
        let entry = module.code.iter().find(|instruction| instruction.op == op::ENTRY_POINT);
        let entry = entry.map(|instruction| module.operands(*instruction)[1]).ok_or("the module has no entry point")?;
        let main = new.function_of(entry).ok_or("the entry point's function is missing")?;
        new.reach(new.functions[main].blocks.start);
        new.settle();
        Ok(new)
    }

    /// The block with this label.
    pub fn block_at(&self, label: u32) -> u32 {
        self.block_of[self.definition[label as usize] as usize]
    }

    /// The block of the instruction with this index; [`NONE`] outside of functions.
    pub fn block_at_index(&self, index: u32) -> u32 {
        self.block_of[index as usize]
    }

    /// The index of the function with this identifier.
    pub fn function_of(&self, id: u32) -> Option<usize> {
        let first = self.definition[id as usize];
        self.functions.binary_search_by_key(&first, |function| function.first).ok()
    }

    /// The local variable that a pointer points into, or the pointer itself where that is none.
    pub fn root(&self, mut pointer: u32) -> u32 {
        loop {
            let Some(instruction) = self.module.code.get(self.definition[pointer as usize] as usize) else {
                return pointer;
            };
            match instruction.op {
                op::ACCESS_CHAIN | op::IN_BOUNDS_ACCESS_CHAIN | op::COPY_OBJECT => {
                    pointer = self.module.operands(*instruction)[0]
                }
                _ => return pointer,
            }
        }
    }

    /// Whether this is a variable of a function.
    pub fn is_local(&self, id: u32) -> bool {
        let index = self.definition[id as usize] as usize;
        self.module.code.get(index).is_some_and(|instruction| instruction.op == op::VARIABLE)
            && self.block_of[index] != NONE
    }

    /// Whether a branch's condition is known, and the branch can go: one back to a loop's start stays, as a loop has exactly one.
    pub fn branch_taken(&self, index: u32) -> Option<u32> {
        let instruction = self.module.code[index as usize];
        let operands = self.module.operands(instruction);
        let condition = self.known[operands[0] as usize].bits()?;
        let block = self.block_of[index as usize];
        if instruction.op == op::SWITCH {
            let case = operands[2..].chunks_exact(2).find(|case| u64::from(case[0]) == condition);
            return Some(case.map_or(operands[1], |case| case[1]));
        }
        let goes_back = operands[1..3].iter().any(|label| self.block_at(*label) <= block);
        (!goes_back).then(|| operands[if condition == 1 { 1 } else { 2 }])
    }

    fn structure(module: &'a Module<'a>) -> Result<Self, String> {
        let (count, bound) = (module.code.len(), module.bound as usize);
        let mut new = Self {
            module,
            definition: vec![NONE; bound],
            known: vec![Known::Nothing; bound],
            blocks: Vec::new(),
            reached: Vec::new(),
            functions: Vec::new(),
            edges: HashSet::new(),
            widths: vec![0; bound],
            is_cell: vec![false; bound],
            cells: vec![Known::Nothing; bound],
            users: vec![Vec::new(); bound],
            block_of: vec![NONE; count],
            block_queue: Vec::new(),
            queue: Vec::new(),
        };
        let mut open = NONE;
        for (index, instruction) in (0u32..).zip(&module.code) {
            if let Some(id) = module.result(*instruction)
                && std::mem::replace(&mut new.definition[id as usize], index) != NONE
            {
                return Err(format!("identifier {id} is defined twice"));
            }
            let function = new.functions.len() as u32;
            match instruction.op {
                op::TYPE_BOOL | op::TYPE_INT | op::TYPE_FLOAT => {
                    let width = if instruction.op == op::TYPE_BOOL { 1 } else { module.operands(*instruction)[0] };
                    if !(1..=64).contains(&width) {
                        return Err(format!("a number of {width} bits"));
                    }
                    module.result(*instruction).into_iter().for_each(|id| new.widths[id as usize] = width);
                }
                op::FUNCTION | op::FUNCTION_PARAMETER | op::FUNCTION_END if open != NONE => {
                    return Err(String::from("a block has no end"));
                }
                op::FUNCTION => {
                    let blocks = new.blocks.len() as u32;
                    new.functions.push(Function { first: index, blocks: blocks..blocks, ..Function::default() });
                }
                op::FUNCTION_PARAMETER => {
                    new.functions.last_mut().ok_or("a parameter outside of a function")?.parameters.push(index);
                }
                op::LABEL => {
                    open = new.blocks.len() as u32;
                    new.blocks.push(Block { first: index, last: NONE, function: function.wrapping_sub(1) });
                    new.functions.last_mut().ok_or("a block outside of a function")?.blocks.end = open + 1;
                }
                _ => {}
            }
            new.block_of[index as usize] = open;
            if op::is_terminator(instruction.op) {
                new.blocks.get_mut(open as usize).ok_or("a branch outside of a block")?.last = index;
                open = NONE;
            }
        }
        let whole = new.blocks.iter().all(|block| block.last != NONE)
            && new.functions.iter().all(|function| !function.blocks.is_empty());
        if !whole {
            return Err(String::from("a function has no block, or a block no end"));
        }
        for (index, instruction) in (0u32..).zip(&module.code) {
            for id in module.ids(*instruction) {
                if new.definition[id as usize] == NONE {
                    return Err(format!("identifier {id} is not defined"));
                }
                if new.definition[id as usize] >= index && !op::looks_ahead(instruction.op) {
                    return Err(format!("identifier {id} is used before it is defined"));
                }
                new.users[id as usize].push(index);
            }
            new.check(index, *instruction)?;
        }
        new.reached = vec![false; new.blocks.len()];
        Ok(new)
    }

    /// Whether what it names as labels are some of its function, and a constant is of a type that constants can have.
    fn check(&self, index: u32, instruction: Instruction) -> Result<(), String> {
        let function = |index: u32| self.blocks.get(self.block_of[index as usize] as usize).map(|block| block.function);
        for label in op::labels(instruction.op, self.module.operands(instruction)) {
            let at = self.definition[label as usize];
            let is_label = self.module.code[at as usize].op == op::LABEL;
            if !is_label || function(index).is_none() || function(at) != function(index) {
                return Err(format!("identifier {label} is no block of the function that goes there"));
            }
        }
        let is_scalar = matches!(
            instruction.op,
            op::CONSTANT_TRUE
                | op::CONSTANT_FALSE
                | op::CONSTANT
                | op::SPEC_CONSTANT_TRUE
                | op::SPEC_CONSTANT_FALSE
                | op::SPEC_CONSTANT
        );
        match self.module.result_type(instruction).filter(|_| is_scalar) {
            Some(ty) if self.widths[ty as usize] == 0 => Err(format!("type {ty} has no constants")),
            _ => Ok(()),
        }
    }

    /// Scalars in local variables, and behind parameters that are only loaded from.
    fn find_cells(&mut self) {
        let module = self.module;
        let is_scalar_pointer = |widths: &[u32], ty: u32| {
            let pointer = module.code[self.definition[ty as usize] as usize];
            pointer.op == op::TYPE_POINTER && widths[module.operands(pointer)[1] as usize] > 0
        };
        let ids: Vec<(u32, bool)> = (0u32..)
            .zip(&module.code)
            .filter(|(index, instruction)| {
                instruction.op == op::FUNCTION_PARAMETER
                    || instruction.op == op::VARIABLE && self.block_of[*index as usize] != NONE
            })
            .filter(|(_, instruction)| {
                module.result_type(**instruction).is_some_and(|ty| is_scalar_pointer(&self.widths, ty))
            })
            .filter_map(|(_, instruction)| Some((module.result(*instruction)?, instruction.op == op::VARIABLE)))
            .collect();
        for (id, _) in ids.iter().filter(|(_, is_variable)| !is_variable) {
            self.is_cell[*id as usize] =
                self.users[*id as usize].iter().all(|user| module.code[*user as usize].op == op::LOAD);
        }
        for (id, _) in ids.iter().filter(|(_, is_variable)| *is_variable) {
            let allowed = |user: &u32| {
                let instruction = module.code[*user as usize];
                match instruction.op {
                    op::LOAD | op::DECORATE => true,
                    op::STORE => module.operands(instruction)[1] != *id,
                    op::FUNCTION_CALL => {
                        let operands = module.operands(instruction);
                        let Some(callee) = self.function_of(operands[0]) else { return false };
                        let given = operands[1..].iter().zip(&self.functions[callee].parameters);
                        given.filter(|(argument, _)| *argument == id).all(|(_, parameter)| {
                            module
                                .result(module.code[*parameter as usize])
                                .is_some_and(|parameter| self.is_cell[parameter as usize])
                        })
                    }
                    _ => false,
                }
            };
            self.is_cell[*id as usize] = self.users[*id as usize].iter().all(allowed);
        }
    }

    fn globals(&mut self, constants: &[(u32, u32)]) {
        let module = self.module;
        let mut given = vec![None; module.bound as usize];
        for instruction in module.code.iter().filter(|instruction| instruction.op == op::DECORATE) {
            if let &[target, op::SPEC_ID, id] = module.operands(*instruction) {
                given[target as usize] = constants.iter().find(|(constant, _)| *constant == id).map(|(_, bits)| *bits);
            }
        }
        for (index, instruction) in module.code.iter().enumerate() {
            let (Some(id), Some(ty)) = (module.result(*instruction), module.result_type(*instruction)) else {
                continue;
            };
            if self.block_of[index] != NONE || matches!(instruction.op, op::FUNCTION | op::FUNCTION_PARAMETER) {
                continue;
            }
            let width = self.widths[ty as usize];
            let given = given[id as usize].map(u64::from);
            let operands = module.operands(*instruction);
            let bits = match instruction.op {
                op::CONSTANT_TRUE => Some(1),
                op::CONSTANT_FALSE => Some(0),
                op::CONSTANT_NULL if width > 0 => Some(0),
                op::SPEC_CONSTANT_TRUE => Some(given.map_or(1, |bits| u64::from(bits != 0))),
                op::SPEC_CONSTANT_FALSE => Some(given.map_or(0, |bits| u64::from(bits != 0))),
                op::CONSTANT | op::SPEC_CONSTANT => Some(
                    given.unwrap_or(u64::from(operands[0]) | operands.get(1).map_or(0, |high| u64::from(*high) << 32)),
                ),
                op::SPEC_CONSTANT_OP if width > 0 && operands[0] == u32::from(op::COMPOSITE_EXTRACT) => {
                    self.extracted(operands[1], &operands[2..]).bits()
                }
                op::SPEC_CONSTANT_OP if width > 0 => {
                    let known = |id: &u32| self.known.get(*id as usize).copied().unwrap_or(Known::Varying);
                    let known: Vec<Known> = operands[1..].iter().map(known).collect();
                    fold::fold(operands[0] as u16, width, self.width_of(operands[1]), &known)
                }
                _ => None,
            };
            self.known[id as usize] = bits.map_or(Known::Varying, |bits| Known::Constant(Scalar { ty, bits }));
        }
    }

    /// Bits of a scalar, 0 for anything else.
    fn width_of(&self, id: u32) -> u32 {
        let defined = self.module.code.get(self.definition[id as usize] as usize);
        defined.and_then(|instruction| self.module.result_type(*instruction)).map_or(0, |ty| self.widths[ty as usize])
    }

    /// A part of a composite that is put together in plain sight.
    fn extracted(&self, composite: u32, path: &[u32]) -> Known {
        let instruction = self.module.code[self.definition[composite as usize] as usize];
        let operands = self.module.operands(instruction);
        let is_struct_or_array_like =
            matches!(instruction.op, op::CONSTANT_COMPOSITE | op::SPEC_CONSTANT_COMPOSITE | op::COMPOSITE_CONSTRUCT);
        // A vector can be made of shorter ones: then places do not count operands.
        let all_scalars = || operands.iter().all(|operand| self.width_of(*operand) > 0);
        match path {
            [index] if is_struct_or_array_like && all_scalars() => {
                operands.get(*index as usize).map_or(Known::Varying, |part| self.known[*part as usize])
            }
            _ => Known::Varying,
        }
    }

    fn reach(&mut self, block: u32) {
        if !std::mem::replace(&mut self.reached[block as usize], true) {
            self.block_queue.push(block);
        }
    }

    fn follow(&mut self, from: u32, label: u32) {
        let to = self.block_at(label);
        if self.edges.insert((from, to)) {
            if self.reached[to as usize] {
                // Its phis have one more value to choose from.
                let Block { first, last, .. } = self.blocks[to as usize];
                self.queue.extend((first..last).filter(|index| self.module.code[*index as usize].op == op::PHI));
            }
            self.reach(to);
        }
    }

    /// Evaluates what is waiting until nothing changes any more.
    fn settle(&mut self) {
        loop {
            if let Some(block) = self.block_queue.pop() {
                let Block { first, last, .. } = self.blocks[block as usize];
                (first..=last).for_each(|index| self.evaluate(index));
            } else if let Some(index) = self.queue.pop() {
                let block = self.block_of[index as usize];
                if block != NONE && self.reached[block as usize] {
                    self.evaluate(index);
                }
            } else if !self.decide_undefined() {
                return;
            }
        }
    }

    /// Lets a branch whose condition is never given a value go either way; false where there is none.
    fn decide_undefined(&mut self) -> bool {
        let module = self.module;
        let undecided =
            self.blocks.iter().zip(&self.reached).filter(|(_, reached)| **reached).find_map(|(block, _)| {
                let instruction = module.code[block.last as usize];
                let is_branch = matches!(instruction.op, op::BRANCH_CONDITIONAL | op::SWITCH);
                let condition = is_branch.then(|| module.operands(instruction)[0])?;
                (self.known[condition as usize] == Known::Nothing).then_some(condition)
            });
        if let Some(condition) = undecided {
            self.learn(condition, Known::Varying);
        }
        undecided.is_some()
    }

    fn learn(&mut self, id: u32, known: Known) {
        let new = self.known[id as usize].or(known);
        if self.known[id as usize] != new {
            self.known[id as usize] = new;
            self.queue.extend_from_slice(&self.users[id as usize]);
        }
    }

    fn store(&mut self, cell: u32, known: Known) {
        let new = self.cells[cell as usize].or(known);
        if self.cells[cell as usize] != new {
            self.cells[cell as usize] = new;
            self.queue.extend_from_slice(&self.users[cell as usize]);
        }
    }

    fn evaluate(&mut self, index: u32) {
        let module = self.module;
        let instruction = module.code[index as usize];
        let operands = module.operands(instruction);
        let block = self.block_of[index as usize];
        match instruction.op {
            op::BRANCH => self.follow(block, operands[0]),
            op::BRANCH_CONDITIONAL | op::SWITCH => {
                if let Some(label) = self.branch_taken(index) {
                    self.follow(block, label);
                } else if self.known[operands[0] as usize] != Known::Nothing {
                    module.ids(instruction).skip(1).for_each(|label| self.follow(block, label));
                }
            }
            op::STORE if self.is_cell[operands[0] as usize] => {
                self.store(operands[0], self.known[operands[1] as usize])
            }
            op::RETURN_VALUE => {
                let function = self.blocks[block as usize].function as usize;
                let old = self.functions[function].returned.unwrap_or(Known::Nothing);
                let new = old.or(self.known[operands[0] as usize]);
                self.functions[function].returned = Some(new);
                if new != old {
                    self.queue.extend_from_slice(&self.functions[function].calls);
                }
            }
            op::FUNCTION_CALL => self.call(index, instruction, operands),
            op::VARIABLE => {
                if let (Some(id), Some(start)) = (module.result(instruction), operands.get(1)) {
                    self.store(id, self.known[*start as usize]);
                }
            }
            _ => {
                if let (Some(id), Some(ty)) = (module.result(instruction), module.result_type(instruction)) {
                    let known = self.value(block, instruction, ty, operands);
                    self.learn(id, known);
                }
            }
        }
    }

    fn call(&mut self, index: u32, instruction: Instruction, operands: &[u32]) {
        let module = self.module;
        let Some(callee) = self.function_of(operands[0]) else { return };
        if !self.functions[callee].calls.contains(&index) {
            self.functions[callee].calls.push(index);
        }
        for (argument, parameter) in operands[1..].iter().zip(self.functions[callee].parameters.clone()) {
            let Some(parameter) = module.result(module.code[parameter as usize]) else { continue };
            if self.is_cell[parameter as usize] {
                let known =
                    if self.is_cell[*argument as usize] { self.cells[*argument as usize] } else { Known::Varying };
                self.store(parameter, known);
            } else {
                self.learn(parameter, self.known[*argument as usize]);
            }
        }
        self.reach(self.functions[callee].blocks.start);
        if let Some(id) = module.result(instruction) {
            self.learn(id, self.functions[callee].returned.unwrap_or(Known::Nothing));
        }
    }

    /// What is known of a value that an instruction gives.
    fn value(&self, block: u32, instruction: Instruction, ty: u32, operands: &[u32]) -> Known {
        let width = self.widths[ty as usize];
        if width == 0 {
            return if instruction.op == op::UNDEF { Known::Nothing } else { Known::Varying };
        }
        match instruction.op {
            op::UNDEF => Known::Nothing,
            op::PHI => {
                let possible =
                    operands.chunks_exact(2).filter(|pair| self.edges.contains(&(self.block_at(pair[1]), block)));
                possible.map(|pair| self.known[pair[0] as usize]).fold(Known::Nothing, Known::or)
            }
            op::LOAD if self.is_cell[operands[0] as usize] => self.cells[operands[0] as usize],
            op::COMPOSITE_EXTRACT => self.extracted(operands[0], &operands[1..]),
            op::SELECT => match self.known[operands[0] as usize] {
                Known::Constant(Scalar { bits, .. }) => self.known[operands[if bits == 1 { 1 } else { 2 }] as usize],
                known => known,
            },
            op::COPY_OBJECT | op::BITCAST | op::S_NEGATE..=op::NOT => {
                let known: Vec<Known> = operands.iter().map(|id| self.known[*id as usize]).collect();
                match fold::fold(instruction.op, width, self.width_of(operands[0]), &known) {
                    Some(bits) => Known::Constant(Scalar { ty, bits }),
                    None if known.contains(&Known::Nothing) => Known::Nothing,
                    None => Known::Varying,
                }
            }
            _ => Known::Varying,
        }
    }
}
