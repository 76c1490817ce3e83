//! Writes the pages of the book to OUT_DIR, where `src/lib.rs` takes them from: the chapters of `src` and those of the repository's `docs`.

mod page;

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use page::{Page, Repository};

/// Chapters of `docs`, which are read in the repository, too.
const DOCS: [&str; 3] = ["comparisons.md", "reference.md", "verified.md"];

fn main() -> io::Result<()> {
    let (src, docs) = (Path::new("src"), Path::new("../../docs"));
    let out = PathBuf::from(std::env::var_os("OUT_DIR").ok_or(io::ErrorKind::NotFound)?);
    // folders, too, so that a new file is seen
    println!("cargo::rerun-if-changed=src");
    println!("cargo::rerun-if-changed=build");
    let mut chapters = Vec::new();
    markdown(src, &mut chapters)?;
    for file in &chapters {
        let target = out.join(file.strip_prefix(src).expect("a file of src"));
        write(file, &target, Page { pictures: src, repository: None })?;
    }
    let repository = Repository { url: &format!("{}/blob/HEAD", env!("CARGO_PKG_REPOSITORY")), folder: "docs" };
    for name in DOCS {
        let file = docs.join(name);
        println!("cargo::rerun-if-changed={}", file.display());
        write(&file, &out.join("docs").join(name), Page { pictures: docs, repository: Some(repository) })?;
    }
    Ok(())
}

/// All files `*.md` of a folder and the folders in it.
fn markdown(folder: &Path, files: &mut Vec<PathBuf>) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            markdown(&path, files)?;
        } else if path.extension().is_some_and(|e| e == "md") {
            files.push(path);
        }
    }
    Ok(())
}

/// Writes the page of a file, or reports what is wrong with it, each mistake with file and line.
fn write(file: &Path, target: &Path, page: Page<'_>) -> io::Result<()> {
    match page.render(&fs::read_to_string(file)?) {
        Ok(rendered) => {
            fs::create_dir_all(target.parent().expect("a folder below OUT_DIR"))?;
            fs::write(target, rendered)?;
        }
        Err(mistakes) => {
            for mistake in mistakes {
                println!("cargo::error={}:{}: {}", file.display(), mistake.line, mistake.message);
            }
        }
    }
    Ok(())
}
