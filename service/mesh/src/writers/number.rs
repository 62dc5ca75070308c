//! Figures as text, quickly and with as few digits as they need.

/// Writes a figure with at most `decimals` digits behind the point, without closing zeros.
pub fn push(out: &mut String, value: f64, decimals: u32) {
    let unit = 10_i64.pow(decimals);
    let scaled = (value * unit as f64).round();
    if scaled.abs() > 9.0e15 {
        out.push_str(&format!("{value:e}"));
        return;
    }
    let scaled = scaled as i64;
    if scaled < 0 {
        out.push('-');
    }
    let (whole, mut rest) = (scaled.unsigned_abs() / unit as u64, scaled.unsigned_abs() % unit as u64);
    let mut digits = [0_u8; 20];
    let mut at = digits.len();
    let mut left = whole;
    loop {
        at -= 1;
        digits[at] = b'0' + (left % 10) as u8;
        left /= 10;
        if left == 0 {
            break;
        }
    }
    out.extend(digits[at..].iter().map(|d| char::from(*d)));
    if rest > 0 {
        out.push('.');
        let mut place = unit as u64 / 10;
        while rest > 0 {
            out.push(char::from(b'0' + (rest / place) as u8));
            rest %= place;
            place /= 10;
        }
    }
}

/// Returns a figure with six digits behind the point.
pub fn n(value: f64) -> String {
    let mut out = String::new();
    push(&mut out, value, 6);
    out
}

/// Returns a figure with nine digits that count: the moments of a thin plate are a sum to the sixth digit, and simulators
/// refuse moments that no body can have.
pub fn small(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return "0".to_owned();
    }
    let digits = (9 - value.abs().log10().ceil() as i32).clamp(0, 18);
    let rounded = format!("{value:.*}", digits as usize);
    if rounded.contains('.') { rounded.trim_end_matches('0').trim_end_matches('.').to_owned() } else { rounded }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_short_and_exact() {
        for (value, expected) in [
            (0.0, "0"),
            (-0.0, "0"),
            (1.5, "1.5"),
            (-0.05, "-0.05"),
            (12.000001, "12.000001"),
            (0.0000004, "0"),
            (-123.4567891, "-123.456789"),
        ] {
            assert_eq!(n(value), expected);
        }
        for (value, expected) in [
            (0.0, "0"),
            (1.0, "1"),
            (0.00000012345678912, "0.000000123456789"),
            (1234.567891234, "1234.56789"),
            (-0.02, "-0.02"),
        ] {
            assert_eq!(small(value), expected);
        }
    }
}
