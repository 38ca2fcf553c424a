//! The instructions of SPIR-V that glslang writes for compute shaders: their numbers, and which of their words are identifiers
//! (SPIR-V specification 1.6, section 3.52; `SPV_KHR_ray_query` for ray queries).

/// What the operands of an instruction are, behind its result type and its result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operands {
    /// So many identifiers, then literals only.
    Ids(u8),
    /// Identifiers only.
    AllIds,
    /// `OpExtInst`: an identifier, a literal, then identifiers.
    ExtInst,
    /// `OpEntryPoint`: a literal, an identifier, a string, then identifiers.
    EntryPoint,
    /// An identifier and a literal, then identifiers.
    IdLiteralIds,
    /// A literal, then identifiers.
    LiteralIds,
    /// `OpSpecConstantOp`: the number of an instruction, then that one's operands.
    SpecConstantOp,
    /// `OpSwitch`: two identifiers, then pairs of a literal and an identifier.
    Switch,
}

/// An instruction's row in the table.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// Whether it has a result type.
    pub typed: bool,
    /// Whether it has a result.
    pub result: bool,
    /// Its operands.
    pub operands: Operands,
}

macro_rules! names {
    ($( $name:ident = $number:literal; )*) => { $( #[allow(missing_docs)] pub const $name: u16 = $number; )* };
}

names! {
    SOURCE_CONTINUED = 2; SOURCE = 3; SOURCE_EXTENSION = 4; NAME = 5; MEMBER_NAME = 6; STRING = 7; LINE = 8; NO_LINE = 317;
    MODULE_PROCESSED = 330; UNDEF = 1; EXTENSION = 10; EXT_INST_IMPORT = 11; EXT_INST = 12; MEMORY_MODEL = 14; ENTRY_POINT = 15;
    EXECUTION_MODE = 16; CAPABILITY = 17; EXECUTION_MODE_ID = 331;
    TYPE_VOID = 19; TYPE_BOOL = 20; TYPE_INT = 21; TYPE_FLOAT = 22; TYPE_ARRAY = 28; TYPE_RUNTIME_ARRAY = 29; TYPE_STRUCT = 30; TYPE_POINTER = 32;
    TYPE_FUNCTION = 33; TYPE_FORWARD_POINTER = 39;
    CONSTANT_TRUE = 41; CONSTANT_FALSE = 42; CONSTANT = 43; CONSTANT_COMPOSITE = 44; CONSTANT_NULL = 46; SPEC_CONSTANT_TRUE = 48;
    SPEC_CONSTANT_FALSE = 49; SPEC_CONSTANT = 50; SPEC_CONSTANT_COMPOSITE = 51; SPEC_CONSTANT_OP = 52;
    FUNCTION = 54; FUNCTION_PARAMETER = 55; FUNCTION_END = 56; FUNCTION_CALL = 57; VARIABLE = 59; LOAD = 61; STORE = 62;
    ACCESS_CHAIN = 65; IN_BOUNDS_ACCESS_CHAIN = 66; DECORATE = 71; MEMBER_DECORATE = 72; VECTOR_SHUFFLE = 79; COMPOSITE_CONSTRUCT = 80;
    COMPOSITE_EXTRACT = 81; COMPOSITE_INSERT = 82; COPY_OBJECT = 83; BITCAST = 124; S_NEGATE = 126; I_ADD = 128; I_SUB = 130; I_MUL = 132; U_DIV = 134;
    U_MOD = 137; LOGICAL_EQUAL = 164; LOGICAL_NOT_EQUAL = 165; LOGICAL_OR = 166; LOGICAL_AND = 167; LOGICAL_NOT = 168; SELECT = 169;
    I_EQUAL = 170; I_NOT_EQUAL = 171; U_GREATER_THAN = 172; S_GREATER_THAN = 173; U_GREATER_THAN_EQUAL = 174;
    S_GREATER_THAN_EQUAL = 175; U_LESS_THAN = 176; S_LESS_THAN = 177; U_LESS_THAN_EQUAL = 178; S_LESS_THAN_EQUAL = 179;
    SHIFT_RIGHT_LOGICAL = 194; SHIFT_RIGHT_ARITHMETIC = 195; SHIFT_LEFT_LOGICAL = 196; BITWISE_OR = 197; BITWISE_XOR = 198;
    BITWISE_AND = 199; NOT = 200; PHI = 245; LOOP_MERGE = 246; SELECTION_MERGE = 247; LABEL = 248; BRANCH = 249;
    BRANCH_CONDITIONAL = 250; SWITCH = 251; KILL = 252; RETURN = 253; RETURN_VALUE = 254; UNREACHABLE = 255;
}

/// Whether it is there for people and tools only.
pub fn is_debug(op: u16) -> bool {
    matches!(
        op,
        SOURCE_CONTINUED | SOURCE | SOURCE_EXTENSION | NAME | MEMBER_NAME | STRING | LINE | NO_LINE | MODULE_PROCESSED
    )
}

/// Whether a block ends with it.
pub fn is_terminator(op: u16) -> bool {
    (BRANCH..=UNREACHABLE).contains(&op)
}

/// Whether it computes with numbers: negation, sums, products, quotients, of vectors and matrices too.
pub fn is_arithmetic(op: u16) -> bool {
    const DOT: u16 = 148;
    (S_NEGATE..=DOT).contains(&op)
}

/// Whether dropping it changes nothing where nobody reads its result. Calls and variables are not asked.
pub fn is_pure(op: u16) -> bool {
    const CONTROL_BARRIER: u16 = 224;
    const ATOMIC_XOR: u16 = 242;
    const ATOMIC_FLOAT_ADD: u16 = 6035;
    const RAY_QUERY_INITIALIZE: u16 = 4473;
    const RAY_QUERY_PROCEED: u16 = 4477;
    const COPY_MEMORY: u16 = 63;
    !((CONTROL_BARRIER..=ATOMIC_XOR).contains(&op)
        || (RAY_QUERY_INITIALIZE..=RAY_QUERY_PROCEED).contains(&op)
        || matches!(op, ATOMIC_FLOAT_ADD | STORE | COPY_MEMORY | FUNCTION_CALL | LABEL))
}

/// Operands without which an instruction of those that are looked into means nothing.
pub fn fewest_operands(op: u16) -> u32 {
    match op {
        TYPE_INT
        | TYPE_FLOAT
        | CONSTANT
        | SPEC_CONSTANT
        | FUNCTION_CALL
        | ACCESS_CHAIN
        | IN_BOUNDS_ACCESS_CHAIN
        | COPY_OBJECT
        | BITCAST
        | BRANCH
        | RETURN_VALUE => 1,
        TYPE_POINTER | SPEC_CONSTANT_OP => 2,
        SELECT => 3,
        S_NEGATE..=NOT => 1,
        _ => 0,
    }
}

/// The operands that are labels of blocks, by their places.
pub fn labels(op: u16, operands: &[u32]) -> Vec<u32> {
    let every_second = |from: usize| operands.iter().skip(from).step_by(2).copied().collect();
    match op {
        BRANCH | SELECTION_MERGE => operands[..1].to_vec(),
        LOOP_MERGE => operands[..2].to_vec(),
        BRANCH_CONDITIONAL => operands[1..3].to_vec(),
        SWITCH | PHI => every_second(1),
        _ => Vec::new(),
    }
}

/// Whether it may refer to what is defined behind it.
pub fn looks_ahead(op: u16) -> bool {
    const DECORATE_ID: u16 = 332;
    is_terminator(op)
        || matches!(
            op,
            PHI | LOOP_MERGE
                | SELECTION_MERGE
                | FUNCTION_CALL
                | ENTRY_POINT
                | EXECUTION_MODE
                | EXECUTION_MODE_ID
                | DECORATE
                | MEMBER_DECORATE
                | DECORATE_ID
                | TYPE_FORWARD_POINTER
                | TYPE_STRUCT
        )
}

/// An instruction's row; none for one that is not known here.
pub fn row(op: u16) -> Option<Row> {
    use Operands::*;
    let (typed, result, operands) = match op {
        UNDEF | CONSTANT_TRUE | CONSTANT_FALSE | CONSTANT_NULL | SPEC_CONSTANT_TRUE | SPEC_CONSTANT_FALSE
        | FUNCTION_PARAMETER => (true, true, Ids(0)),
        CONSTANT | SPEC_CONSTANT => (true, true, Ids(0)),
        CONSTANT_COMPOSITE | SPEC_CONSTANT_COMPOSITE | COMPOSITE_CONSTRUCT | PHI => (true, true, AllIds),
        SPEC_CONSTANT_OP => (true, true, SpecConstantOp),
        EXTENSION | MEMORY_MODEL | CAPABILITY => (false, false, Ids(0)),
        EXT_INST_IMPORT => (false, true, Ids(0)),
        EXT_INST => (true, true, ExtInst),
        ENTRY_POINT => (false, false, EntryPoint),
        EXECUTION_MODE => (false, false, Ids(1)),
        EXECUTION_MODE_ID | 332 => (false, false, IdLiteralIds),
        // OpTypeVoid, bool, int, float; vector, matrix, image; array; runtime array.
        19..=22 => (false, true, Ids(0)),
        23..=25 => (false, true, Ids(1)),
        TYPE_ARRAY => (false, true, Ids(2)),
        TYPE_RUNTIME_ARRAY => (false, true, Ids(1)),
        TYPE_STRUCT | TYPE_FUNCTION => (false, true, AllIds),
        TYPE_POINTER => (false, true, LiteralIds),
        TYPE_FORWARD_POINTER => (false, false, Ids(1)),
        // OpTypeRayQueryKHR, OpTypeAccelerationStructureKHR.
        4472 | 5341 => (false, true, Ids(0)),
        FUNCTION | VARIABLE => (true, true, LiteralIds),
        FUNCTION_END => (false, false, Ids(0)),
        FUNCTION_CALL => (true, true, AllIds),
        LOAD => (true, true, Ids(1)),
        // OpStore, OpCopyMemory.
        STORE | 63 => (false, false, Ids(2)),
        ACCESS_CHAIN | IN_BOUNDS_ACCESS_CHAIN => (true, true, AllIds),
        // OpArrayLength; OpVectorExtractDynamic, OpVectorInsertDynamic.
        68 => (true, true, Ids(1)),
        77 | 78 => (true, true, AllIds),
        VECTOR_SHUFFLE | COMPOSITE_INSERT => (true, true, Ids(2)),
        COMPOSITE_EXTRACT => (true, true, Ids(1)),
        COPY_OBJECT | 84 | 400 => (true, true, AllIds),
        DECORATE => (false, false, Ids(1)),
        MEMBER_DECORATE => (false, false, Ids(1)),
        // Conversions, arithmetic, logic, comparisons, bits.
        109..=157 | 164..=191 | 194..=205 => (true, true, AllIds),
        // Barriers and atomics.
        224 | 225 | 228 => (false, false, AllIds),
        227 | 229..=242 | 6035 => (true, true, AllIds),
        LOOP_MERGE => (false, false, Ids(2)),
        SELECTION_MERGE => (false, false, Ids(1)),
        LABEL => (false, true, Ids(0)),
        BRANCH | RETURN_VALUE => (false, false, AllIds),
        BRANCH_CONDITIONAL => (false, false, Ids(3)),
        SWITCH => (false, false, Switch),
        KILL | RETURN | UNREACHABLE => (false, false, Ids(0)),
        // Ray queries: initialise, terminate, generate, confirm; proceed, type; what is known of an intersection.
        4473..=4476 => (false, false, AllIds),
        4477 | 4479 | 6016..=6032 => (true, true, AllIds),
        _ => return None,
    };
    Some(Row { typed, result, operands })
}

/// The decoration that gives a constant its `constant_id`.
pub(super) const SPEC_ID: u32 = 1;
/// The decoration that forbids regrouping.
pub(super) const NO_CONTRACTION: u32 = 42;
/// `BuiltIn WorkgroupSize`: means something by being there.
pub(super) const WORKGROUP_SIZE: [u32; 2] = [11, 25];
