//! What instructions make of constants: the value of one whose operands are known, or of which those that are known decide.
//!
//! Whole numbers and truth values only. What a kernel models is decided by these; arithmetic on floats is left to the driver, so that its
//! bits are those that the driver gives it.

use super::op;

/// A scalar: its bits, with those above its width zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Scalar {
    /// The identifier of its type.
    pub ty: u32,
    /// Its bits; of a truth value 0 or 1.
    pub bits: u64,
}

/// What is known of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Known {
    /// Nothing yet: no path that was found possible gives it one.
    Nothing,
    /// It is this, on all paths.
    Constant(Scalar),
    /// It may differ from run to run.
    Varying,
}

impl Known {
    /// What is known where it is either.
    pub fn or(self, other: Self) -> Self {
        match (self, other) {
            (Self::Nothing, known) | (known, Self::Nothing) => known,
            (Self::Constant(a), Self::Constant(b)) if a.bits == b.bits => self,
            _ => Self::Varying,
        }
    }

    /// Its bits, where it is constant.
    pub fn bits(self) -> Option<u64> {
        match self {
            Self::Constant(scalar) => Some(scalar.bits),
            _ => None,
        }
    }
}

/// The bits of an instruction's result of a type with `width` bits, operands having `operand_width`; none where these do not
/// decide it, or the instruction is not one that is folded here.
pub fn fold(number: u16, width: u32, operand_width: u32, operands: &[Known]) -> Option<u64> {
    let of = |k: usize| operands.get(k).copied().unwrap_or(Known::Varying).bits();
    // One operand can decide.
    match number {
        op::LOGICAL_AND if of(0) == Some(0) || of(1) == Some(0) => return Some(0),
        op::LOGICAL_OR if of(0) == Some(1) || of(1) == Some(1) => return Some(1),
        op::SELECT => return if of(0)? == 1 { of(1) } else { of(2) },
        op::BITWISE_AND | op::I_MUL if of(0) == Some(0) || of(1) == Some(0) => return Some(0),
        _ => {}
    }
    let a = of(0)?;
    let unary = match number {
        op::LOGICAL_NOT => Some(u64::from(a == 0)),
        op::NOT => Some(!a),
        op::S_NEGATE => Some(a.wrapping_neg()),
        op::COPY_OBJECT => Some(a),
        op::BITCAST if width == operand_width => Some(a),
        _ => None,
    };
    if let Some(bits) = unary {
        return Some(cut(bits, width));
    }
    let b = of(1)?;
    let (signed_a, signed_b) = (signed(a, operand_width), signed(b, operand_width));
    let shift = u32::try_from(b).ok().filter(|shift| *shift < width);
    let bits = match number {
        op::LOGICAL_AND | op::BITWISE_AND => a & b,
        op::LOGICAL_OR | op::BITWISE_OR => a | b,
        op::BITWISE_XOR => a ^ b,
        op::LOGICAL_EQUAL | op::I_EQUAL => u64::from(a == b),
        op::LOGICAL_NOT_EQUAL | op::I_NOT_EQUAL => u64::from(a != b),
        op::U_GREATER_THAN => u64::from(a > b),
        op::U_GREATER_THAN_EQUAL => u64::from(a >= b),
        op::U_LESS_THAN => u64::from(a < b),
        op::U_LESS_THAN_EQUAL => u64::from(a <= b),
        op::S_GREATER_THAN => u64::from(signed_a > signed_b),
        op::S_GREATER_THAN_EQUAL => u64::from(signed_a >= signed_b),
        op::S_LESS_THAN => u64::from(signed_a < signed_b),
        op::S_LESS_THAN_EQUAL => u64::from(signed_a <= signed_b),
        op::I_ADD => a.wrapping_add(b),
        op::I_SUB => a.wrapping_sub(b),
        op::I_MUL => a.wrapping_mul(b),
        op::U_DIV => a.checked_div(b)?,
        op::U_MOD => a.checked_rem(b)?,
        op::SHIFT_LEFT_LOGICAL => a << shift?,
        op::SHIFT_RIGHT_LOGICAL => a >> shift?,
        op::SHIFT_RIGHT_ARITHMETIC => (signed(a, width) >> shift?) as u64,
        _ => return None,
    };
    Some(cut(bits, width))
}

/// The low `width` bits.
fn cut(bits: u64, width: u32) -> u64 {
    if width >= 64 { bits } else { bits & ((1 << width) - 1) }
}

/// The low `width` bits as a number with a sign.
fn signed(bits: u64, width: u32) -> i64 {
    let unused = 64 - width.clamp(1, 64);
    (bits << unused) as i64 >> unused
}

#[cfg(test)]
mod tests {
    use super::*;

    fn constant(bits: u64) -> Known {
        Known::Constant(Scalar { ty: 1, bits })
    }

    #[test]
    fn one_operand_can_decide() {
        assert_eq!(fold(op::LOGICAL_AND, 1, 1, &[Known::Varying, constant(0)]), Some(0));
        assert_eq!(fold(op::LOGICAL_AND, 1, 1, &[Known::Varying, constant(1)]), None);
        assert_eq!(fold(op::LOGICAL_OR, 1, 1, &[constant(1), Known::Varying]), Some(1));
        assert_eq!(fold(op::SELECT, 32, 1, &[constant(1), constant(7), Known::Varying]), Some(7));
        assert_eq!(fold(op::SELECT, 32, 1, &[constant(0), constant(7), Known::Varying]), None);
    }

    #[test]
    fn numbers_keep_their_width_and_sign() {
        let (one, all) = (constant(1), constant(0xffff_ffff));
        assert_eq!(fold(op::I_ADD, 32, 32, &[all, one]), Some(0));
        assert_eq!(fold(op::NOT, 32, 32, &[one]), Some(0xffff_fffe));
        assert_eq!(fold(op::S_LESS_THAN, 1, 32, &[all, one]), Some(1));
        assert_eq!(fold(op::U_LESS_THAN, 1, 32, &[all, one]), Some(0));
        assert_eq!(fold(op::SHIFT_RIGHT_ARITHMETIC, 32, 32, &[all, constant(4)]), Some(0xffff_ffff));
        assert_eq!(fold(op::SHIFT_LEFT_LOGICAL, 32, 32, &[one, constant(32)]), None, "undefined");
        assert_eq!(fold(op::U_DIV, 32, 32, &[one, constant(0)]), None, "undefined");
        assert_eq!(fold(op::LOGICAL_NOT, 1, 1, &[one]), Some(0));
    }
}
