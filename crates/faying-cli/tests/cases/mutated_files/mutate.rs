//! Mutations of bytes, words and lines; the same on every machine.

/// A generator of numbers (Steele, Lea, Flood: SplitMix64).
pub struct Random(pub u64);

impl Random {
    pub fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % n.max(1) as u64) as usize
    }

    pub fn pick<'a>(&mut self, from: &[&'a str]) -> &'a str {
        from[self.below(from.len())]
    }
}

/// What a number becomes.
const NUMBERS: [&str; 22] = [
    "0",
    "1",
    "-1",
    "2",
    "3",
    "4",
    "7",
    "15",
    "92",
    "0.5",
    "-0.25",
    "1e-9",
    "1e9",
    "1e-320",
    "1e308",
    "1e400",
    "nan",
    "inf",
    "4294967296",
    "4000000",
    "1152921504606846976",
    "18446744073709551615",
];

/// Words between white space and signs of XML.
fn words(bytes: &[u8]) -> Vec<std::ops::Range<usize>> {
    let splits = |b: u8| b.is_ascii_whitespace() || matches!(b, b'<' | b'>' | b'"' | b'=' | b',' | b'[' | b']' | b'{' | b'}');
    let mut list = Vec::new();
    let mut from = 0;
    for (k, &b) in bytes.iter().chain(b" ").enumerate() {
        if splits(b) {
            if k > from {
                list.push(from..k);
            }
            from = k + 1;
        }
    }
    list
}

fn is_number(word: &[u8]) -> bool {
    std::str::from_utf8(word).is_ok_and(|w| w.parse::<f64>().is_ok())
}

/// Ranges of lines, line breaks left out.
fn lines(bytes: &[u8]) -> Vec<std::ops::Range<usize>> {
    let mut from = 0;
    let mut list = Vec::new();
    for (k, &b) in bytes.iter().chain(b"\n").enumerate() {
        if b == b'\n' {
            list.push(from..k);
            from = k + 1;
        }
    }
    list
}

/// One mutation of a file, text or not.
pub fn mutate(bytes: &mut Vec<u8>, r: &mut Random) {
    if bytes.is_empty() {
        bytes.push(b'0');
    }
    let at = r.below(bytes.len());
    match r.below(16) {
        0 => bytes[at] = r.below(256) as u8,
        1 => bytes[at] ^= 1 << r.below(8),
        2 => bytes.truncate(at),
        3 => {
            let end = (at + 1 + r.below(40)).min(bytes.len());
            bytes.drain(at..end);
        }
        4 => {
            // eight bytes of a count or a number
            let value = [1u64 << 60, u64::MAX, 0, 1 << 31, f64::NAN.to_bits(), f64::MAX.to_bits()][r.below(6)];
            let end = bytes.len().min(at + 8);
            bytes[at..end].copy_from_slice(&value.to_le_bytes()[..end - at]);
        }
        5 => {
            let all = lines(bytes);
            let line = all[r.below(all.len())].clone();
            let end = (line.end + 1).min(bytes.len());
            bytes.drain(line.start.min(end)..end);
        }
        6 | 7 => {
            // a line stands once more somewhere
            let all = lines(bytes);
            let mut line = bytes[all[r.below(all.len())].clone()].to_vec();
            line.push(b'\n');
            let to = all[r.below(all.len())].start;
            bytes.splice(to..to, line);
        }
        8 => {
            let all = lines(bytes);
            let (a, b) = (r.below(all.len()), r.below(all.len()));
            let (first, second) = (all[a.min(b)].clone(), all[a.max(b)].clone());
            let (one, other) = (bytes[first.clone()].to_vec(), bytes[second.clone()].to_vec());
            if a != b {
                bytes.splice(second, one);
                bytes.splice(first, other);
            }
        }
        9 => {
            // a word in the place of another
            let all = words(bytes);
            if !all.is_empty() {
                let word = bytes[all[r.below(all.len())].clone()].to_vec();
                let place = all[r.below(all.len())].clone();
                bytes.splice(place, word);
            }
        }
        _ => {
            let all: Vec<_> = words(bytes).into_iter().filter(|w| is_number(&bytes[w.clone()])).collect();
            if !all.is_empty() {
                let place = all[r.below(all.len())].clone();
                let other = bytes[all[r.below(all.len())].clone()].to_vec();
                let new = if r.below(3) == 0 { other } else { r.pick(&NUMBERS).as_bytes().to_vec() };
                bytes.splice(place, new);
            }
        }
    }
}

/// Keys that a block may not have yet.
const KEYS: [&str; 24] = [
    "degree = 1",
    "degree = [3, 1]",
    "continuity = 0",
    "elements = 4000000",
    "elements = [2, 2, 2]",
    "refine = 1",
    "refine = 40",
    "backend = \"fe\"",
    "backend = \"iga\"",
    "cells = \"simplex\"",
    "mapping = \"exact\"",
    "closed = \"u\"",
    "glue = false",
    "where = \"x > 0.5\"",
    "where = \"1/0\"",
    "between = \"all\"",
    "coupling = \"glue\"",
    "coupling = \"nitsche\"",
    "multiplier = \"constant\"",
    "fix = [\"normal\"]",
    "rigid_force = { x = 1 }",
    "force = { z = 1 }",
    "extrude = 1",
    "material = \"steel\"",
];

/// Words of a case that stand for each other.
const FAMILIES: [&[&str]; 8] = [
    &["u0", "u1", "v0", "v1", "w0", "w1", "all-outer", "u0v0", "left", "top"],
    &["iga", "fe"],
    &["auto", "p/p", "p/p-2", "p/p-1", "constant", "dual"],
    &["mortar", "glue", "nitsche", "penalty"],
    &["squares-nurbs.mesh", "beam-nurbs.mesh", "mixed-v2.msh", "cube-nurbs.mesh", "hexagon.xml", "nothing.msh", "."],
    &["box", "file", "disc-sector", "annulus-sector", "sphere-octant", "plate-with-hole", "nurbs"],
    &["poisson", "elasticity"],
    &["normal", "tangential", "x", "y", "z"],
];

/// One mutation of a case.
pub fn mutate_case(text: &str, r: &mut Random) -> String {
    match r.below(8) {
        0 => {
            let mut lines: Vec<&str> = text.lines().collect();
            lines.insert(r.below(lines.len()), r.pick(&KEYS));
            lines.join("\n")
        }
        1 | 2 => {
            let family = FAMILIES[r.below(FAMILIES.len())];
            let ends = ["\"", ".", "]"];
            let mut places = Vec::new();
            for word in family {
                places.extend(text.match_indices(word).map(|(k, w)| k..k + w.len()).filter(|p| {
                    let before = text[..p.start].ends_with(['"', '.']);
                    before && ends.iter().any(|e| text[p.end..].starts_with(e))
                }));
            }
            match places.get(r.below(places.len())) {
                Some(place) => format!("{}{}{}", &text[..place.start], r.pick(family), &text[place.end..]),
                None => text.to_owned(),
            }
        }
        3 => {
            // blocks change their order, or stand twice
            let mut blocks: Vec<String> = text.split("\n[").map(str::to_owned).collect();
            let (a, b) = (r.below(blocks.len()), r.below(blocks.len()));
            if r.below(2) == 0 {
                blocks.swap(a, b);
            } else {
                let copy = blocks[a].clone();
                blocks.insert(b, copy);
            }
            blocks.join("\n[")
        }
        _ => {
            let mut bytes = text.as_bytes().to_vec();
            mutate(&mut bytes, r);
            String::from_utf8_lossy(&bytes).into_owned()
        }
    }
}
