//! Files that are wrong: each is refused with its place, within the memory allowed.

use super::{bytes, data};
use faying_files::gmsh::{parse, write};
use faying_files::{FileError, Limits, MeshFile, Spot};

/// Memory that the small meshes of these tests may take, the bytes of the file counted.
const ALLOWED: u64 = 300_000;

/// Memory beside the lists that a reader grows: messages, nodes of an element type, standard maps.
const SLACK: u64 = 60_000;

/// A simple generator: the tests are the same everywhere (Steele, Lea, Flood: SplitMix64).
pub struct Random(pub u64);

impl Random {
    fn next(&mut self, below: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % below as u64) as usize
    }
}

/// Reads while counting memory: at no time more than allowed.
fn measured(bytes: &[u8]) -> Result<MeshFile, FileError> {
    let mut result = None;
    let info = allocation_counter::measure(|| result = Some(parse(bytes, &Limits { memory: Some(ALLOWED) })));
    assert!(info.bytes_max + bytes.len() as u64 <= ALLOWED + SLACK, "{} bytes in use", info.bytes_max);
    result.unwrap()
}

pub fn mutate(random: &mut Random, bytes: &mut Vec<u8>) {
    for _ in 0..=random.next(3) {
        let at = random.next(bytes.len());
        match random.next(9) {
            0 => bytes[at] = random.next(256) as u8,
            1 => bytes[at] ^= 1 << random.next(8),
            2 => bytes.truncate(at.max(1)),
            3 => drop(bytes.splice(at..at, b"-".iter().copied())),
            4 => drop(bytes.splice(at..at, b"9999999999999".iter().copied())),
            5 => drop(bytes.splice(at..at, b" nan ".iter().copied())),
            6 => drop(bytes.splice(at..(at + 1 + random.next(40)).min(bytes.len()), [])),
            7 => {
                let part = bytes[at..(at + 1 + random.next(80)).min(bytes.len())].to_vec();
                let to = random.next(bytes.len());
                drop(bytes.splice(to..to, part));
            }
            _ => {
                let n = bytes.len().min(at + 8);
                bytes[at..n].copy_from_slice(&(1u64 << 60).to_le_bytes()[..n - at]);
            }
        }
        if bytes.is_empty() {
            bytes.push(b'$');
        }
    }
}

#[test]
pub fn mutated_files_are_read_or_refused_within_the_memory_allowed() {
    let (mut read, mut refused) = (0, 0);
    for (seed, name) in
        ["disc_tri_p1_v4_bin.msh", "disc_quad_p2_v4_bin.msh", "octant_tet_p1_v2_bin.msh", "box_hex_p3_v2.msh", "box_hex_p3_v4.msh"]
            .iter()
            .enumerate()
    {
        let good = bytes(name);
        let mut random = Random(seed as u64);
        for _ in 0..2000 {
            let mut bad = good.clone();
            mutate(&mut random, &mut bad);
            match measured(&bad) {
                Ok(mesh) => {
                    read += 1;
                    // what was read can be used: every node is there
                    assert!(mesh.blocks.iter().flat_map(|b| &b.nodes).all(|n| (*n as usize) < mesh.points.len()));
                    let _ = (mesh.cells::<2>(None), mesh.cells::<3>(None), write(&mesh, true));
                }
                Err(FileError::Unsupported { spot, .. } | FileError::Broken { spot, .. }) => {
                    refused += 1;
                    assert!(spot.is_some());
                }
                Err(FileError::Memory { .. }) => refused += 1,
                Err(other) => panic!("{other:?}"),
            }
        }
    }
    println!("{read} read, {refused} refused");
    assert!(read > 500 && refused > 5000, "{read} read, {refused} refused");
}

const HEAD: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
const NODES: &str = "$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n";

fn refusal(text: &str) -> String {
    measured(text.as_bytes()).unwrap_err().to_string()
}

#[test]
fn mistakes_in_text_name_their_line() {
    let cases = [
        (format!("{HEAD}$Nodes\n1152921504606846976\n1 0 0 0\n$EndNodes\n"), "expected a whole number, found `$EndNodes` (line 7)"),
        (format!("{HEAD}$Nodes\n-3\n"), "expected a whole number that is not negative, found `-3` (line 5)"),
        (format!("{HEAD}$Nodes\n1\n-1 0 0 0\n$EndNodes\n"), "a node or element has a number that is not positive (line 6)"),
        (format!("{HEAD}$Nodes\n1\n1 0 nan 0\n$EndNodes\n"), "a node at [0.0, NaN, 0.0] (line 6)"),
        (format!("{HEAD}$Nodes\n1\n1 0 1e999 0\n$EndNodes\n"), "a node at [0.0, inf, 0.0] (line 6)"),
        (format!("{HEAD}$Nodes\n1\n1 0 0\n$EndNodes\n"), "expected a number, found `$EndNodes` (line 7)"),
        (format!("{HEAD}$Nodes\n2\n1 0 0 0\n1 0 0 1\n$EndNodes\n"), "node 1 stands twice in $Nodes (line 4)"),
        (format!("{HEAD}$Nodes\n1\n1 0 0 0 0\n$EndNodes\n"), "expected the end of the line, found `0` (line 6)"),
        (format!("{HEAD}{NODES}$Elements\n1\n1 2 0 1 2 4\n$EndElements\n"), "element 1 refers to node 4, which is not in $Nodes (line 12)"),
        (format!("{HEAD}{NODES}$Elements\n1\n1 16 0 1 2 3 1 2 3 1 2\n"), "is not supported (line 12)"),
        (format!("{HEAD}{NODES}$Elements\n2\n1 2 0 1 2 3\n$EndElements\n"), "expected a whole number, found `$EndElements` (line 13)"),
        (format!("{HEAD}{NODES}$Elements\n1\n1 2 0 1 2"), "expected a whole number, the file ends (line 12)"),
        (format!("{HEAD}{NODES}"), "the file has no $Elements (line 10)"),
        (format!("{HEAD}{NODES}{NODES}"), "a second $Nodes (line 10)"),
        (format!("{HEAD}$Elements\n0\n$EndElements\n"), "$Elements stands before $Nodes (line 4)"),
        (NODES.to_owned(), "a section of data stands before $MeshFormat (line 1)"),
        ("$NOD\n1\n1 0 0 0\n$ENDNOD\n".to_owned(), "MSH version 1 (2.2 and 4.1 are read) is not supported (line 1)"),
        (
            "$MeshFormat\n4 0 8\n$EndMeshFormat\n".to_owned(),
            "MSH version 4 (2.2 and 4.1 are read; save with -format msh41) is not supported (line 2)",
        ),
        (format!("{HEAD}$Periodic\n1\n"), "section $Periodic has no end (line 4)"),
        (format!("{HEAD}$PhysicalNames\n1\n2 1 disc\n"), "expected the name of the group between quotes (line 6)"),
        (String::new(), "the file has no $MeshFormat (line 1)"),
    ];
    for (text, expected) in cases {
        let found = refusal(&text);
        assert!(found.ends_with(expected), "{text}\nsays `{found}`, not `{expected}`");
    }
}

#[test]
fn mistakes_in_binary_data_name_their_byte() {
    let good = bytes("disc_tri_p1_v4_bin.msh");
    let find = |word: &[u8]| good.windows(word.len()).position(|w| w == word).unwrap();
    let nodes = find(b"$Nodes\n") + 7;
    let mut bad = good.clone();
    bad[nodes..nodes + 8].copy_from_slice(&(1u64 << 60).to_le_bytes());
    assert!(matches!(measured(&bad), Err(FileError::Broken { spot: Some(Spot::Byte(_)), .. })));
    let cut = good[..find(b"$EndNodes") - 20].to_vec();
    assert!(measured(&cut).unwrap_err().to_string().starts_with("the file ends inside binary data (byte "));
    // 2^60 nodes in one block
    let mut bad = good.clone();
    bad[nodes + 44..nodes + 52].copy_from_slice(&(1u64 << 60).to_le_bytes());
    assert!(measured(&bad).is_err());
    let mut swapped = good.clone();
    swapped[find(b"4.1 1 8\n") + 8] = 7;
    assert!(measured(&swapped).unwrap_err().to_string().contains("either order of bytes (byte "));
    assert!(measured(&vec![0; 10_000]).unwrap_err().to_string().contains("expected the $Name of a section"));
}

#[test]
fn the_other_order_of_bytes_reads_the_same() {
    // version 2.2 holds ints and doubles only: swap them by hand
    let text = b"$MeshFormat\n2.2 1 8\n".to_vec();
    let make = |big: bool| {
        let int = |v: i32| if big { v.to_be_bytes() } else { v.to_le_bytes() };
        let real = |v: f64| if big { v.to_be_bytes() } else { v.to_le_bytes() };
        let mut out = text.clone();
        out.extend(int(1));
        out.extend(b"\n$EndMeshFormat\n$Nodes\n3\n");
        for (n, x) in [(1, [0.0, 0.0, 0.0]), (2, [1.5, 0.0, 0.0]), (3, [0.0, 2.5, 0.0])] {
            out.extend(int(n));
            x.iter().for_each(|x| out.extend(real(*x)));
        }
        out.extend(b"\n$EndNodes\n$Elements\n1\n");
        [2, 1, 2, 9, 4, 1, 1, 2, 3].iter().for_each(|v| out.extend(int(*v)));
        out.extend(b"\n$EndElements\n");
        measured(&out).unwrap()
    };
    assert_eq!(make(true), make(false));
    assert_eq!(make(true).groups[0].number, 4);
}

#[test]
fn memory_is_refused_before_it_is_taken() {
    let file = write(&data("octant_tet_p4_v2_bin.msh"), false).unwrap();
    let mut last = None;
    for allowed in [file.len() as u64, file.len() as u64 + 20_000, 1 << 30] {
        let mut result = None;
        let info = allocation_counter::measure(|| result = Some(parse(&file, &Limits { memory: Some(allowed) })));
        assert!(info.bytes_max + file.len() as u64 <= allowed + SLACK);
        last = result;
        if allowed < 1 << 30 {
            assert_eq!(crate::kind(last.as_ref().unwrap().as_ref().unwrap_err()), "memory");
        }
    }
    assert!(last.unwrap().is_ok());
}
