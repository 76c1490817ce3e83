//! The program against files made to hurt it: endless, empty, lying about their counts, going in circles, larger than the memory allowed.

use faying_files::{CellShape, Format, Group, MeshBlock, MeshFile, gmsh};
use std::io::{Read, Write};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Memory of the program itself, its threads and buffers of pipes [bytes].
const PROGRAM: u64 = 30_000_000;
/// Longest time until a hostile input is refused; far more than any takes.
const PATIENCE: Duration = Duration::from_secs(120);

/// How a process ended.
#[derive(Debug)]
struct End {
    exit: Option<i32>,
    stderr: String,
    /// Most memory it held, where the system says it [bytes].
    peak: Option<u64>,
    /// Bytes of its input that it took.
    taken: u64,
}

fn high_water(process: u32) -> Option<u64> {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    line.split_whitespace().next()?.parse::<u64>().ok().map(|k| k * 1024)
}

/// Runs the program in `folder`; `feed` writes its input until the pipe breaks.
fn faying(folder: &Path, words: &[&str], feed: impl FnOnce(&mut dyn Write) -> std::io::Result<()> + Send + 'static) -> End {
    let mut child = Command::new(env!("CARGO_BIN_EXE_faying"))
        .args(words)
        .current_dir(folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let input = child.stdin.take().unwrap();
    let feeder = std::thread::spawn(move || {
        let mut counted = Counted { inner: input, bytes: 0 };
        // the program may stop listening at any byte
        let _ = feed(&mut counted);
        counted.bytes
    });
    let mut stderr = child.stderr.take().unwrap();
    let listener = std::thread::spawn(move || {
        let mut text = String::new();
        stderr.read_to_string(&mut text).map(|_| text)
    });
    let (begin, mut peak) = (Instant::now(), None);
    let exit = loop {
        peak = peak.max(high_water(child.id()));
        if let Some(status) = child.try_wait().unwrap() {
            break status.code();
        }
        if begin.elapsed() > PATIENCE {
            child.kill().unwrap();
            panic!("{words:?} does not end");
        }
        std::thread::sleep(Duration::from_millis(2));
    };
    End { exit, stderr: listener.join().unwrap().unwrap(), peak, taken: feeder.join().unwrap() }
}

struct Counted<W> {
    inner: W,
    bytes: u64,
}

impl<W: Write> Write for Counted<W> {
    fn write(&mut self, buffer: &[u8]) -> std::io::Result<usize> {
        let n = self.inner.write(buffer)?;
        self.bytes += n as u64;
        Ok(n)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.inner.flush()
    }
}

impl End {
    /// Exit, code, and memory below `allowed` beside the program itself.
    #[track_caller]
    fn expect(&self, exit: i32, code: &str, allowed: u64) -> &Self {
        assert_eq!(self.exit, Some(exit), "{self:?}");
        assert!(self.stderr.contains(&format!("error[{code}]")), "{self:?}");
        assert!(self.stderr.contains("= help: "), "{self:?}");
        assert!(self.peak.is_none_or(|p| p <= allowed + PROGRAM), "{self:?}");
        self
    }
}

fn silent(_: &mut dyn Write) -> std::io::Result<()> {
    Ok(())
}

/// A Poisson case on a file.
fn case(file: &str, dimension: usize) -> String {
    format!(
        "[model]\nphysics = \"poisson\"\ndimension = {dimension}\nsource = 1\n[[patch]]\nname = \"body\"\n\
         geometry = {{ kind = \"file\", file = \"{file}\" }}\nbackend = \"fe\"\n[[boundary]]\non = \"all-outer\"\ndirichlet = 0\n"
    )
}

fn folder(files: &[(&str, &[u8])]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        std::fs::write(folder.path().join(name), bytes).unwrap();
    }
    folder
}

/// All commands that read a file; each word FILE stands for it, each CASE for a case on it.
const COMMANDS: [&[&str]; 5] =
    [&["run", "CASE"], &["check", "CASE"], &["compare", "CASE"], &["inspect", "FILE"], &["convert", "FILE", "out.vtu"]];

fn every_command(folder: &Path, file: &str, dimension: usize, limit: &str) -> Vec<End> {
    std::fs::write(folder.join("case.toml"), case(file, dimension)).unwrap();
    let word = |w: &&'static str| match *w {
        "FILE" => file.to_owned(),
        "CASE" => "case.toml".to_owned(),
        other => other.to_owned(),
    };
    COMMANDS
        .iter()
        .map(|command| {
            let mut words: Vec<String> = command.iter().map(word).collect();
            if !limit.is_empty() {
                words.extend(["--max-memory".to_owned(), limit.to_owned()]);
            }
            let end = faying(folder, &words.iter().map(String::as_str).collect::<Vec<_>>(), silent);
            assert!(!folder.join("case.out").exists() && !folder.join("out.vtu").exists(), "{words:?} leaves something behind");
            end
        })
        .collect()
}

#[test]
fn a_line_of_a_gigabyte_is_left_at_the_longest_case() {
    let folder = folder(&[]);
    for start in ["", "title = \"", "x = [", "# "] {
        for command in ["run", "check", "inspect"] {
            let end = faying(folder.path(), &[command, "-"], move |to| {
                to.write_all(start.as_bytes())?;
                let block = vec![b'a'; 1 << 16];
                (0..1 << 14).try_for_each(|_| to.write_all(&block))
            });
            end.expect(6, "E081", 64 << 20);
            assert!(end.taken < 20 << 20, "{} bytes are read", end.taken);
        }
    }
}

#[test]
fn zeros_and_files_without_an_end_are_refused() {
    let folder = folder(&[]);
    // 8 GB that take no place on the disk
    std::fs::File::create(folder.path().join("large.msh")).unwrap().set_len(8 << 30).unwrap();
    std::fs::File::create(folder.path().join("zeros.msh")).unwrap().set_len(20 << 20).unwrap();
    std::fs::write(folder.path().join("empty.msh"), "").unwrap();
    for end in every_command(folder.path(), "large.msh", 2, "200MB") {
        end.expect(6, "E081", 0);
    }
    for end in every_command(folder.path(), "zeros.msh", 2, "200MB") {
        end.expect(3, "E043", 200_000_000);
    }
    for end in every_command(folder.path(), "empty.msh", 2, "") {
        end.expect(3, "E043", 0);
    }
    if Path::new("/dev/zero").exists() {
        for end in every_command(folder.path(), "/dev/zero", 2, "") {
            assert!(end.exit == Some(4) && end.stderr.contains("/dev/zero"), "{end:?}");
            assert!(end.peak.is_none_or(|p| p < PROGRAM), "{end:?}");
        }
        for command in ["run", "check"] {
            faying(folder.path(), &[command, "/dev/zero"], silent).expect(6, "E081", 64 << 20);
        }
    }
    // a pipe into `inspect` is read up to the limit
    if Path::new("/dev/stdin").exists() {
        let endless = |to: &mut dyn Write| {
            to.write_all(b"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1000000000\n")?;
            (1u64..).try_for_each(|n| writeln!(to, "{n} 0 0 0"))
        };
        let end = faying(folder.path(), &["inspect", "/dev/stdin", "--max-memory", "20MB"], endless);
        end.expect(6, "E081", 20_000_000);
        assert!(end.taken < 30_000_000, "{} bytes are read", end.taken);
    }
}

#[test]
fn counts_of_two_to_the_sixty_are_not_believed() {
    const HUGE: u64 = 1 << 60;
    let gmsh2 = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
    let binary = |section: &str, counts: &[u64]| {
        let mut bytes = b"$MeshFormat\n4.1 1 8\n\x01\0\0\0\n$EndMeshFormat\n".to_vec();
        bytes.extend_from_slice(format!("${section}\n").as_bytes());
        counts.iter().for_each(|n| bytes.extend_from_slice(&n.to_le_bytes()));
        bytes.extend_from_slice(&[0; 4000]);
        bytes
    };
    let geometry = |knots: &str, points: &str| {
        format!(
            "<xml><Geometry type=\"TensorBSpline2\" id=\"0\"><Basis type=\"TensorBSplineBasis2\"><Basis type=\"BSplineBasis\" index=\"0\">{knots}</Basis>\
             <Basis type=\"BSplineBasis\" index=\"1\"><KnotVector degree=\"1\">0 0 1 1</KnotVector></Basis></Basis>{points}</Geometry></xml>"
        )
    };
    let line = "<KnotVector degree=\"1\">0 0 1 1</KnotVector>";
    let square = "<coefs geoDim=\"2\">0 0 1 0 0 1 1 1</coefs>";
    let files: Vec<(&str, Vec<u8>)> = vec![
        ("nodes.msh", format!("{gmsh2}$Nodes\n{HUGE}\n1 0 0 0\n$EndNodes\n").into()),
        ("elements.msh", format!("{gmsh2}$Nodes\n1\n1 0 0 0\n$EndNodes\n$Elements\n{HUGE}\n1 15 0 1\n$EndElements\n").into()),
        ("names.msh", format!("{gmsh2}$PhysicalNames\n{HUGE}\n1 1 \"x\"\n$EndPhysicalNames\n").into()),
        ("tags.msh", format!("{gmsh2}$Nodes\n1\n1 0 0 0\n$EndNodes\n$Elements\n1\n1 15 {HUGE} 1 1\n$EndElements\n").into()),
        ("blocks.msh", binary("Nodes", &[HUGE, HUGE, 1, HUGE])),
        ("entities.msh", binary("Entities", &[HUGE; 4])),
        ("data.msh", binary("Elements", &[HUGE; 4])),
        ("cells.mesh", format!("MFEM mesh v1.0\ndimension\n2\nelements\n{HUGE}\n1 3 0 1 2 3\nboundary\n0\nvertices\n4\n2\n0 0\n1 0\n1 1\n0 1\n").into()),
        ("vertices.mesh", format!("MFEM mesh v1.0\ndimension\n2\nelements\n1\n1 3 0 1 2 3\nboundary\n0\nvertices\n{HUGE}\n2\n0 0\n1 0\n1 1\n0 1\n").into()),
        (
            "knots.mesh",
            format!(
                "MFEM NURBS mesh v1.0\ndimension\n2\nelements\n1\n1 3 0 1 2 3\nboundary\n0\nedges\n4\n0 0 1\n0 3 2\n1 0 3\n1 1 2\nvertices\n4\n\
                 knotvectors\n2\n1 {HUGE} 0 0 1 1\n1 2 0 0 1 1\nweights\n1 1 1 1\n"
            )
            .into(),
        ),
        (
            "degree.mesh",
            format!(
                "MFEM NURBS mesh v1.0\ndimension\n2\nelements\n1\n1 3 0 1 2 3\nboundary\n0\nedges\n4\n0 0 1\n0 3 2\n1 0 3\n1 1 2\nvertices\n4\n\
                 knotvectors\n2\n{HUGE} {HUGE} 0 0 1 1\n1 2 0 0 1 1\nweights\n1 1 1 1\n"
            )
            .into(),
        ),
        ("degree.xml", geometry(&format!("<KnotVector degree=\"{HUGE}\">0 0 1 1</KnotVector>"), square).into()),
        ("coefs.xml", geometry(line, &format!("<coefs geoDim=\"{HUGE}\">0 0 1 0 0 1 1 1</coefs>")).into()),
        ("range.xml", format!("<xml><MultiPatch parDim=\"2\" id=\"9\"><patches type=\"id_range\">0 {HUGE}</patches></MultiPatch></xml>").into()),
        (
            "grid.vtu",
            format!(
                "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\"><UnstructuredGrid><Piece NumberOfPoints=\"{HUGE}\" NumberOfCells=\"{HUGE}\">\
                 <Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0</DataArray></Points></Piece></UnstructuredGrid></VTKFile>"
            )
            .into(),
        ),
    ];
    for (name, bytes) in files {
        let folder = folder(&[(name, &bytes)]);
        for end in every_command(folder.path(), name, 2, "200MB") {
            assert!(end.exit == Some(3) || end.exit == Some(6), "{name}: {end:?}");
            let code = if end.exit == Some(3) { "E043" } else { "E081" };
            end.expect(end.exit.unwrap(), code, 10_000_000);
        }
    }
}

#[test]
fn circles_of_references_come_to_an_end() {
    // a patch list that names itself, names of sides in a circle, and entities that grow to 10^9 words
    let own = "<xml><MultiPatch parDim=\"2\" id=\"0\"><patches type=\"id_range\">0 0</patches></MultiPatch></xml>";
    let file = "<xml><xmlfile>circle.xml</xmlfile></xml>";
    let entities: String = (1..10).map(|k| format!("<!ENTITY e{k} \"{}\">", format!("&e{};", k - 1).repeat(10))).collect();
    let laughs =
        format!("<?xml version=\"1.0\"?><!DOCTYPE xml [<!ENTITY e0 \"1\">{entities}]><xml><Geometry type=\"&e9;\">&e9;</Geometry></xml>");
    let deep = format!("<xml>{}", "<a>".repeat(200_000));
    let files = [("own.xml", own), ("circle.xml", file), ("laughs.xml", &laughs), ("deep.xml", &deep)];
    for (name, text) in files {
        let folder = folder(&[(name, text.as_bytes())]);
        for end in every_command(folder.path(), name, 2, "200MB") {
            end.expect(3, "E043", 10_000_000);
        }
    }
    #[cfg(unix)]
    {
        let folder = folder(&[]);
        std::os::unix::fs::symlink("b.msh", folder.path().join("a.msh")).unwrap();
        std::os::unix::fs::symlink("a.msh", folder.path().join("b.msh")).unwrap();
        for end in every_command(folder.path(), "a.msh", 2, "") {
            assert_eq!(end.exit, Some(4), "{end:?}");
        }
    }
    // constants and patches of a case
    let folder = folder(&[]);
    let square = "geometry = { kind = \"box\", min = [0, 0], max = [\"a\", 1] }\nelements = [2, 2]\n";
    let circle =
        format!("[let]\na = \"b\"\nb = \"c\"\nc = \"a\"\n[model]\nphysics = \"poisson\"\ndimension = 2\n[[patch]]\nname = \"p\"\n{square}");
    let nested = format!("title = {}", "[".repeat(100_000));
    let formula = format!("[let]\na = \"{}1\"\n", "(".repeat(100_000));
    let keys = format!("{} = 1\n", vec!["a"; 100_000].join("."));
    for (text, code) in [(circle, "E017"), (nested, "E005"), (formula, "E017"), (keys, "")] {
        let end = faying(folder.path(), &["check", "-"], move |to| to.write_all(text.as_bytes()));
        assert_eq!(end.exit, Some(3), "{end:?}");
        assert!(end.stderr.contains(&format!("error[{code}")), "{end:?}");
    }
}

/// [0, 1]^3 in 6 n^3 tetrahedra; the group 1 holds them all.
fn cube(n: usize) -> Vec<u8> {
    let node = |i: usize, j: usize, k: usize| ((k * (n + 1) + j) * (n + 1) + i) as u32;
    let all = || (0..=n).flat_map(move |k| (0..=n).flat_map(move |j| (0..=n).map(move |i| [i, j, k])));
    let points: Vec<[f64; 3]> = all().map(|x| x.map(|v| v as f64 / n as f64)).collect();
    let mut nodes = Vec::new();
    for [i, j, k] in all().filter(|x| x.iter().all(|v| *v < n)) {
        for order in [[0, 1, 2], [1, 2, 0], [2, 0, 1], [1, 0, 2], [0, 2, 1], [2, 1, 0]] {
            let mut x = [i, j, k];
            let mut own = vec![node(x[0], x[1], x[2])];
            for axis in order {
                x[axis] += 1;
                own.push(node(x[0], x[1], x[2]));
            }
            if order == [1, 0, 2] || order == [0, 2, 1] || order == [2, 1, 0] {
                own.swap(1, 2);
            }
            nodes.extend(own);
        }
    }
    let ids = (1..=(nodes.len() / 4) as u64).collect();
    let block = MeshBlock { shape: CellShape::Tetrahedron, order: 1, nodes, ids, groups: vec![0] };
    let group = Group { dimension: 3, number: 1, name: Some("cube".to_owned()) };
    let mesh = MeshFile {
        format: Format::Gmsh,
        ids: (1..=points.len() as u64).collect(),
        points,
        blocks: vec![block],
        groups: vec![group],
        notes: Vec::new(),
    };
    gmsh::write(&mesh, true).unwrap()
}

#[test]
fn meshes_larger_than_the_memory_allowed_are_refused_before_they_are_held() {
    // 196608 tetrahedra, a file of 9 MB
    let folder = folder(&[("cube.msh", &cube(32))]);
    // too little for the file, for what is read from it, for the system of equations
    for end in every_command(folder.path(), "cube.msh", 3, "5MB") {
        end.expect(6, "E081", 5_000_000);
    }
    for end in every_command(folder.path(), "cube.msh", 3, "12MB") {
        end.expect(6, "E081", 12_000_000);
    }
    for command in ["run", "check"] {
        let end = faying(folder.path(), &[command, "case.toml", "--max-memory", "100MB"], silent);
        end.expect(6, "E081", 100_000_000);
    }
    // what a limit lets pass stays below it; what it does not is not begun
    let commands = [&["inspect", "cube.msh"][..], &["convert", "cube.msh", "cube.mesh"], &["convert", "cube.msh", "cube.vtu"]];
    for (limit, passes) in [(30_000_000, false), (200_000_000, true)] {
        for words in commands {
            let text = limit.to_string();
            let words = [words, &["--max-memory", &text]].concat();
            let end = faying(folder.path(), &words, silent);
            println!("{words:?}: {:?} bytes", end.peak);
            if passes {
                assert_eq!(end.exit, Some(0), "{words:?}: {end:?}");
                assert!(end.peak.is_none_or(|p| p <= limit + PROGRAM), "{words:?}: {end:?}");
            } else {
                end.expect(6, "E081", limit);
            }
        }
    }
}

/// The program under a limit of `kilobytes` of address space: `ulimit -v` of the shell that becomes it.
#[cfg(target_os = "linux")]
fn limited(folder: &Path, words: &str, kilobytes: u64) -> (Option<i32>, String) {
    let script = format!("ulimit -v {kilobytes}\nexec {} {words}", env!("CARGO_BIN_EXE_faying"));
    let out = Command::new("sh").args(["-c", &script]).current_dir(folder).stdout(Stdio::null()).output().unwrap();
    (out.status.code(), String::from_utf8_lossy(&out.stderr).into_owned())
}

#[cfg(target_os = "linux")]
#[test]
fn no_sample_dies_where_the_address_space_is_limited() {
    let samples = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("examples/cases");
    let folder = TempDir::new().unwrap();
    let mut cases: Vec<_> = std::fs::read_dir(&samples).unwrap().map(|e| e.unwrap().path()).collect();
    cases.retain(|path| path.extension().is_some_and(|end| end == "toml"));
    assert!(cases.len() > 10);
    for (kilobytes, threads) in [(300_000, 4), (300_000, 1), (500_000, 16), (1_000_000, 2), (2_000_000, 16)] {
        for case in &cases {
            let words = format!("run {} --out {kilobytes} --force -q --threads {threads}", case.display());
            let (exit, stderr) = limited(folder.path(), &words, kilobytes);
            let refused = exit == Some(6) && stderr.contains("error[E081]") && stderr.contains("ulimit -v");
            assert!(exit == Some(0) || refused, "{words} under {kilobytes} kB: {exit:?} {stderr}");
        }
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_limit_of_the_process_refuses_what_it_cannot_hold_before_it_is_built() {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("cube.toml"), CUBE).unwrap();
    for command in ["run", "check"] {
        let begun = Instant::now();
        let (exit, stderr) = limited(folder.path(), &format!("{command} cube.toml --set patch.cube.elements=[150,150,150]"), 1_000_000);
        assert_eq!(exit, Some(6), "{stderr}");
        assert!(stderr.contains("error[E081]") && stderr.contains("the process may map 1.0 GB (ulimit -v)"), "{stderr}");
        assert!(stderr.contains("raise `ulimit -v`"), "{stderr}");
        assert!(begun.elapsed().as_secs() < 20);
    }
}

/// A Poisson cube, whose factor is much larger than its matrix.
const CUBE: &str = "[model]\nphysics = \"poisson\"\ndimension = 3\nsource = 1\n[[patch]]\nname = \"cube\"\n\
     geometry = { kind = \"box\", min = [0, 0, 0], max = [1, 1, 1] }\nbackend = \"fe\"\ndegree = 1\nelements = [50, 50, 50]\n\
     [[boundary]]\non = \"all-outer\"\ndirichlet = 0\n[solver]\nlinear = \"iterative\"\n";

/// Bytes that a refused case is said to need.
fn said(stderr: &str) -> f64 {
    let words: Vec<&str> = stderr.split_whitespace().collect();
    let at = words.iter().position(|w| *w == "memory;").unwrap_or_else(|| panic!("{stderr}"));
    let unit = match words[at - 2] {
        "GB" => 1e9,
        "MB" => 1e6,
        other => panic!("{other}"),
    };
    words[at - 3].parse::<f64>().unwrap() * unit
}

#[test]
fn what_is_solved_without_a_factor_is_not_refused_for_one() {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("cube.toml"), CUBE).unwrap();
    let need = |sets: &[&str]| {
        let words: Vec<&str> =
            ["check", "cube.toml", "--max-memory", "1MB"].into_iter().chain(sets.iter().flat_map(|s| ["--set", *s])).collect();
        let end = faying(folder.path(), &words, silent);
        assert_eq!(end.exit, Some(6), "{end:?}");
        said(&end.stderr)
    };
    // a million unknowns: the factor of them all, and what conjugate gradients take
    let million = "patch.cube.elements=[100,100,100]";
    let (direct, iterative) = (need(&[million, "solver.linear=direct"]), need(&[million]));
    assert!(direct > 10e9 && iterative < 3e9, "{direct:e} {iterative:e}");
    // what is said holds, and is no idle fear
    let small = need(&[]);
    let end = faying(folder.path(), &["run", "cube.toml", "--vtu", "none"], silent);
    assert_eq!(end.exit, Some(0), "{end:?}");
    if let Some(peak) = end.peak {
        println!("said {small:e}, taken {peak:e}");
        assert!((0.4 * small..1.1 * small).contains(&(peak as f64)), "said {small:e}, taken {peak:e}");
    }
}
