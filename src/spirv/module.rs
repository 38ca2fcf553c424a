//! A module of SPIR-V as a list of instructions over its words.

use super::op::{self, Operands, Row};

/// Words before the first instruction: magic number, version, generator, bound of identifiers, schema.
pub const HEADER: usize = 5;
/// The first word of a module.
pub const MAGIC: u32 = 0x0723_0203;

/// One instruction: where it stands, and its row.
#[derive(Clone, Copy, Debug)]
pub struct Instruction {
    /// Its number.
    pub op: u16,
    /// Its first word's place in the module.
    pub at: u32,
    /// Its words, the first one included.
    pub len: u32,
    row: Row,
}

/// A module: the words, and the instructions that they make.
pub struct Module<'a> {
    /// All words.
    pub words: &'a [u32],
    /// The instructions in order, without those that are for people only.
    pub code: Vec<Instruction>,
    /// No identifier reaches it.
    pub bound: u32,
}

impl<'a> Module<'a> {
    /// Takes a module apart. Fails where it is none, or has an instruction that [`op::row`] does not know.
    pub fn parse(words: &'a [u32]) -> Result<Self, String> {
        if words.len() < HEADER || words[0] != MAGIC {
            return Err(String::from("these words are not a SPIR-V module"));
        }
        let bound = words[3];
        // Each identifier is defined by two words or more: what claims more than there can be would have room made for it.
        if bound as usize > words.len() {
            return Err(format!("{bound} identifiers are more than {} words can define", words.len()));
        }
        let mut module = Self { words, code: Vec::new(), bound };
        let mut at = HEADER;
        while at < words.len() {
            let (op, len) = ((words[at] & 0xffff) as u16, (words[at] >> 16) as usize);
            if len == 0 || at + len > words.len() {
                return Err(format!("the instruction at word {at} has {len} words, which are not all there"));
            }
            if !op::is_debug(op) {
                let row = op::row(op).ok_or_else(|| format!("instruction {op} at word {at} is not known"))?;
                let new = Instruction { op, at: at as u32, len: len as u32, row };
                module.check(new)?;
                module.code.push(new);
            }
            at += len;
        }
        Ok(module)
    }

    /// Whether an instruction has the words that its row promises, and identifiers below the bound.
    fn check(&self, instruction: Instruction) -> Result<(), String> {
        let Instruction { op, at, len, row } = instruction;
        let fault = |what: &str| Err(format!("instruction {op} at word {at}: {what}"));
        let ids = match row.operands {
            Operands::Ids(count) => u32::from(count),
            Operands::ExtInst | Operands::Switch | Operands::IdLiteralIds => 2,
            Operands::EntryPoint => 3,
            Operands::LiteralIds | Operands::SpecConstantOp => 1,
            Operands::AllIds => 0,
        };
        let ids = ids.max(op::fewest_operands(op));
        if len < 1 + u32::from(row.typed) + u32::from(row.result) + ids {
            return fault("words are missing");
        }
        // Memory operands with identifiers are those of the Vulkan memory model.
        let memory = match op {
            op::LOAD => self.words.get((at + 4) as usize).filter(|_| len > 4),
            op::STORE => self.words.get((at + 3) as usize).filter(|_| len > 3),
            _ => None,
        };
        if memory.is_some_and(|mask| mask & !7 != 0) {
            return fault("memory operands of the Vulkan memory model are not known");
        }
        if instruction
            .id_places(self.words)
            .chain(instruction.result_place())
            .any(|place| !(1..self.bound).contains(&self.words[place]))
        {
            return fault("an identifier is not below the bound");
        }
        Ok(())
    }

    /// The word of an instruction at this place, 0 being the first.
    pub fn word(&self, instruction: Instruction, place: u32) -> u32 {
        self.words[(instruction.at + place) as usize]
    }

    /// All words of an instruction.
    pub fn words_of(&self, instruction: Instruction) -> &'a [u32] {
        &self.words[instruction.at as usize..(instruction.at + instruction.len) as usize]
    }

    /// The identifier that an instruction defines.
    pub fn result(&self, instruction: Instruction) -> Option<u32> {
        instruction.result_place().map(|place| self.words[place])
    }

    /// The identifier of the type of what it defines.
    pub fn result_type(&self, instruction: Instruction) -> Option<u32> {
        instruction.row.typed.then(|| self.word(instruction, 1))
    }

    /// The operands behind type and result.
    pub fn operands(&self, instruction: Instruction) -> &'a [u32] {
        &self.words_of(instruction)[instruction.first_operand() as usize..]
    }

    /// The identifiers that it refers to, its type first.
    pub fn ids(&self, instruction: Instruction) -> impl Iterator<Item = u32> + '_ {
        instruction.id_places(self.words).map(|place| self.words[place])
    }
}

impl Instruction {
    /// The place of its first operand, counted from its first word.
    pub fn first_operand(self) -> u32 {
        1 + u32::from(self.row.typed) + u32::from(self.row.result)
    }

    /// Where in the module the identifier stands that it defines.
    pub fn result_place(self) -> Option<usize> {
        self.row.result.then_some((self.at + 1 + u32::from(self.row.typed)) as usize)
    }

    /// Where in the module the identifiers stand that it refers to, its type first.
    pub fn id_places(self, words: &[u32]) -> impl Iterator<Item = usize> + '_ {
        let (first, end) = ((self.at + self.first_operand()) as usize, (self.at + self.len) as usize);
        let typed = self.row.typed.then_some(self.at as usize + 1);
        typed.into_iter().chain((first..end).filter(move |place| self.is_id(place - first, &words[first..end])))
    }

    /// Whether operand `k` is an identifier.
    fn is_id(self, k: usize, operands: &[u32]) -> bool {
        match self.row.operands {
            Operands::Ids(count) => k < usize::from(count),
            Operands::AllIds => true,
            Operands::ExtInst | Operands::IdLiteralIds => k != 1,
            Operands::LiteralIds => k != 0,
            Operands::Switch => k < 2 || k % 2 == 1,
            Operands::EntryPoint => {
                // The name ends with the first word that has a zero byte.
                let ends = |word: &u32| word.to_le_bytes().contains(&0);
                k == 1 || k >= 3 + operands[2..].iter().position(ends).unwrap_or(operands.len())
            }
            Operands::SpecConstantOp => match operands[0] as u16 {
                op::COMPOSITE_EXTRACT => k == 1,
                op::VECTOR_SHUFFLE | op::COMPOSITE_INSERT => k == 1 || k == 2,
                _ => k > 0,
            },
        }
    }
}
