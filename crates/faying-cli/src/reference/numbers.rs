//! Lists of numbers as bytes: exact, or rounded, differenced and written with as few bytes as they need.
//!
//! Coefficients of smooth fields on a grid differ little from their neighbours. Rounded to whole multiples of a step, they are replaced
//! by differences along the rows and across them, as often as makes them smallest; whole numbers lose nothing by that.

use std::io::{self, Read};

/// The step of rounding: 2^-44 of the largest.
const BITS: i32 = 44;
/// Most differences in one direction that are tried.
const MOST_TIMES: u8 = 4;
/// The least exponent of a normal number.
const LEAST: i32 = -1022;

/// Appends a whole number, seven bits a byte.
pub fn put_whole(out: &mut Vec<u8>, mut n: u64) {
    while n >= 0x80 {
        out.push(n as u8 | 0x80);
        n >>= 7;
    }
    out.push(n as u8);
}

/// A whole number of [`put_whole`].
pub fn whole(from: &mut impl Read) -> io::Result<u64> {
    let (mut n, mut shift) = (0u64, 0);
    loop {
        let byte = byte(from)?;
        if shift == 63 && byte > 1 {
            return Err(broken("a whole number is too long"));
        }
        n |= u64::from(byte & 0x7f) << shift;
        if byte & 0x80 == 0 {
            return Ok(n);
        }
        shift += 7;
    }
}

/// Error of invalid contents.
pub fn broken(what: impl Into<String>) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, what.into())
}

fn byte(from: &mut impl Read) -> io::Result<u8> {
    let mut one = [0];
    from.read_exact(&mut one)?;
    Ok(one[0])
}

/// 2^e of a normal number.
fn power(e: i32) -> f64 {
    f64::from_bits(((e + 1023) as u64) << 52)
}

/// Appends a list exactly.
pub fn put_exact(out: &mut Vec<u8>, list: &[f64]) {
    put_whole(out, list.len() as u64);
    list.iter().for_each(|x| out.extend(x.to_le_bytes()));
}

/// A list of [`put_exact`]; `room` is called before it grows.
pub fn exact(from: &mut impl Read, room: &mut dyn FnMut(&mut Vec<f64>) -> io::Result<()>) -> io::Result<Vec<f64>> {
    let (count, mut list) = (whole(from)?, Vec::new());
    for _ in 0..count {
        let mut bytes = [0; 8];
        from.read_exact(&mut bytes)?;
        let x = f64::from_le_bytes(bytes);
        if !x.is_finite() {
            return Err(broken("a number is not finite"));
        }
        room(&mut list)?;
        list.push(x);
    }
    Ok(list)
}

/// Replaces a list by its differences over `shift` places.
fn differences(list: &mut [i64], shift: usize) {
    for k in (shift..list.len()).rev() {
        list[k] = list[k].wrapping_sub(list[k - shift]);
    }
}

/// Undoes [`differences`].
fn sums(list: &mut [i64], shift: usize) {
    for k in shift..list.len() {
        list[k] = list[k].wrapping_add(list[k - shift]);
    }
}

fn bits(list: &[i64]) -> u64 {
    list.iter().map(|&n| u64::from(64 - zigzag(n).leading_zeros())).sum()
}

fn zigzag(n: i64) -> u64 {
    ((n << 1) ^ (n >> 63)) as u64
}

/// Appends a list rounded; neighbours are `shift` places apart, rows `row` places (0: no rows).
pub fn put_rounded(out: &mut Vec<u8>, list: &[f64], shift: usize, row: usize) {
    let largest = list.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    let exponent = if largest > 0.0 { (largest.log2().ceil() as i32 - BITS).max(LEAST) } else { 0 };
    let step = power(exponent);
    let plain: Vec<i64> = list.iter().map(|x| (x / step).round() as i64).collect();
    let row = if row > shift && row < list.len() { row } else { 0 };
    let (mut least, mut best, mut kept) = (u64::MAX, (0, 0), Vec::new());
    let mut across = plain;
    for b in 0..=if row > 0 { MOST_TIMES } else { 0 } {
        if b > 0 {
            differences(&mut across, row);
        }
        let mut along = across.clone();
        for a in 0..=MOST_TIMES {
            if a > 0 {
                differences(&mut along, shift);
            }
            let cost = bits(&along);
            if cost < least {
                (least, best) = (cost, (a, b));
                kept.clone_from(&along);
            }
        }
    }
    put_whole(out, list.len() as u64);
    put_whole(out, zigzag(i64::from(exponent)));
    out.extend([best.0, best.1]);
    put_whole(out, shift as u64);
    put_whole(out, row as u64);
    kept.iter().for_each(|&n| put_whole(out, zigzag(n)));
}

/// A list of [`put_rounded`]; `room` is called before it grows.
pub fn rounded(from: &mut impl Read, room: &mut dyn FnMut(&mut Vec<i64>) -> io::Result<()>) -> io::Result<Vec<f64>> {
    let unzigzag = |n: u64| (n >> 1) as i64 ^ -((n & 1) as i64);
    let count = whole(from)?;
    let exponent = unzigzag(whole(from)?);
    if !(i64::from(LEAST)..=1023).contains(&exponent) {
        return Err(broken(format!("the step 2^{exponent} is out of range")));
    }
    let (a, b) = (byte(from)?, byte(from)?);
    let (shift, row) = (whole(from)?, whole(from)?);
    if a > MOST_TIMES || b > MOST_TIMES || (a > 0 && shift == 0) || (b > 0 && row == 0) {
        return Err(broken("differences are out of range"));
    }
    let mut list = Vec::new();
    for _ in 0..count {
        let n = unzigzag(whole(from)?);
        room(&mut list)?;
        list.push(n);
    }
    let (shift, row) = (usize::try_from(shift).unwrap_or(usize::MAX), usize::try_from(row).unwrap_or(usize::MAX));
    (0..a).for_each(|_| sums(&mut list, shift));
    (0..b).for_each(|_| sums(&mut list, row));
    let step = power(exponent as i32);
    let list: Vec<f64> = list.into_iter().map(|n| n as f64 * step).collect();
    if list.iter().all(|x| x.is_finite()) { Ok(list) } else { Err(broken("a number is not finite")) }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn around(list: &[f64], shift: usize, row: usize) -> (Vec<f64>, usize) {
        let mut bytes = Vec::new();
        put_rounded(&mut bytes, list, shift, row);
        (rounded(&mut bytes.as_slice(), &mut |_| Ok(())).unwrap(), bytes.len())
    }

    #[test]
    fn rounded_lists_come_back_within_a_step_whatever_their_size() {
        for scale in [1.0, 1e-300, 1e-9, 3e17, 1e300, 5e-324] {
            let list: Vec<f64> = (0..500).map(|k| scale * ((k * k) as f64 * 0.37).sin()).collect();
            let largest = list.iter().fold(0.0f64, |m, x| m.max(x.abs()));
            for (shift, row) in [(1, 0), (2, 20), (3, 499), (1, 1000)] {
                let (back, _) = around(&list, shift, row);
                let step = (largest * 2f64.powi(-43)).max(f64::MIN_POSITIVE);
                assert!(list.iter().zip(&back).all(|(a, b)| (a - b).abs() <= 0.5 * step), "{scale} {shift} {row}");
            }
        }
        assert_eq!(around(&[0.0; 7], 1, 0).0, vec![0.0; 7]);
        assert_eq!(around(&[], 1, 0).0, Vec::<f64>::new());
    }

    #[test]
    fn a_smooth_field_on_a_grid_needs_less_than_two_bytes_a_number() {
        let n = 200;
        let list: Vec<f64> = (0..n * n).map(|k| ((k % n) as f64 / n as f64 + 0.3).sin() * ((k / n) as f64 / n as f64).exp()).collect();
        let (_, bytes) = around(&list, 1, n);
        assert!(bytes < 2 * n * n, "{bytes} bytes for {} numbers", n * n);
    }

    #[test]
    fn a_declared_count_alone_takes_no_memory() {
        let mut bytes = Vec::new();
        put_whole(&mut bytes, u64::MAX);
        assert!(exact(&mut bytes.as_slice(), &mut |_| Ok(())).is_err());
        assert!(rounded(&mut [bytes.as_slice(), &[0, 0, 0, 1, 0]].concat().as_slice(), &mut |_| Ok(())).is_err());
    }
}
