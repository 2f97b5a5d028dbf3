//! Files, standard streams and the end of the program.

use super::MessageFormat;
use anyhow::Context;
use splinepost::diagnostic::{Diagnostic, Diagnostics, Severity};
use splinepost::front::Language;
use splinepost::source::{Source, SourceId, Sources};
use splinepost::summary::Summary;
use std::fs;
use std::io::{self, IsTerminal, Read, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Where messages go and how they look.
pub(crate) struct Console {
    format: MessageFormat,
    color: bool,
}

impl Console {
    /// Colour only on a terminal, and not where NO_COLOR is set.
    pub(crate) fn new(format: MessageFormat) -> Console {
        let wanted = std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty());
        Console { format, color: wanted && io::stderr().is_terminal() }
    }

    /// Tells diagnostics on standard error.
    pub(crate) fn diagnostics(&self, diagnostics: &Diagnostics, sources: &Sources) {
        let text = match self.format {
            MessageFormat::Text => diagnostics.render(sources, self.color),
            MessageFormat::Json => diagnostics.to_json(sources),
        };
        Console::to_stderr(&text);
    }

    /// Tells a summary on standard error.
    pub(crate) fn summary(&self, summary: &Summary) {
        let text = match self.format {
            MessageFormat::Text => summary.render(),
            MessageFormat::Json => summary.to_json(),
        };
        Console::to_stderr(&text);
    }

    /// Tells figures on standard error: text for people, or a line of JSON.
    pub(crate) fn figures(&self, text: &str, json: &str) {
        Console::to_stderr(match self.format {
            MessageFormat::Text => text,
            MessageFormat::Json => json,
        });
    }

    /// Tells a few lines of text on standard error, where messages are for people.
    pub(crate) fn remark(&self, text: &str) {
        if self.format == MessageFormat::Text {
            Console::to_stderr(text);
        }
    }

    fn to_stderr(text: &str) {
        // Where standard error is closed there is nobody left to tell.
        let _ = io::stderr().write_all(text.as_bytes());
    }

    /// 1 where the answer is no, 2 where something is wrong.
    pub(crate) fn exit_code(diagnostics: &Diagnostics) -> ExitCode {
        match diagnostics.worst() {
            Severity::Refusal => ExitCode::from(1),
            Severity::Error | Severity::Warning | Severity::Note => ExitCode::from(2),
        }
    }
}

/// What a file or a stream did as a diagnostic: what was tried, then why that failed, down to the system's word.
fn failed(id: &'static str, error: &anyhow::Error) -> Diagnostics {
    Diagnostic::error(id, format!("{error:#}")).into()
}

/// The greatest size of an input, in MiB, be it a file, one that it names, or standard input. What has no end, as a device or a
/// pipe that is never closed, is read no farther; a part program of that size is beyond what a control loads.
const MOST_MIB: u64 = 512;

/// All that there is to read, or nothing where it is more than may be.
fn read_at_most(from: impl Read, expected: u64) -> io::Result<Option<Vec<u8>>> {
    let most = MOST_MIB << 20;
    if most < expected {
        return Ok(None);
    }
    let mut bytes = Vec::with_capacity(usize::try_from(expected + 1).unwrap_or_default());
    from.take(most + 1).read_to_end(&mut bytes)?;
    Ok((bytes.len() as u64 <= most).then_some(bytes))
}

/// The bytes of a file at a path.
fn read_file(path: &Path) -> io::Result<Option<Vec<u8>>> {
    let file = fs::File::open(path)?;
    let expected = file.metadata().map_or(0, |about| about.len());
    read_at_most(file, expected)
}

/// What is said of an input that is too large.
fn too_large() -> String {
    format!("larger than {MOST_MIB} MiB, the most that is read of one input")
}

/// The bytes of a file, or of standard input for `-`.
fn read_bytes(path: &str) -> Result<Vec<u8>, Diagnostics> {
    if path != "-" && Path::new(path).is_dir() {
        return Err(Diagnostic::error("file-is-directory", format!("{path} is a directory")).into());
    }
    let (name, read) = if path == "-" {
        let read = read_at_most(io::stdin().lock(), 0);
        ("standard input", read.context("cannot read standard input"))
    } else {
        (path, read_file(Path::new(path)).with_context(|| format!("cannot read {path}")))
    };
    let bytes = read.map_err(|error| failed("file-unreadable", &error))?;
    bytes.ok_or_else(|| {
        Diagnostic::error("file-too-large", format!("{name} is {}", too_large()))
            .hint("a file of that size has to be split into several")
            .into()
    })
}

/// The text of a file, which must be UTF-8.
pub(crate) fn read_text(path: &str) -> Result<String, Diagnostics> {
    String::from_utf8(read_bytes(path)?).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        not_utf8(path, error.as_bytes()[..at].split(|b| *b == b'\n').count())
    })
}

/// What is wrong with a text that is not UTF-8, from this line on.
pub(crate) fn not_utf8(path: &str, line: usize) -> Diagnostics {
    let message = format!("{path} is not UTF-8: line {line} has a byte that cannot be read");
    Diagnostic::error("not-utf8", message).hint("save the file as UTF-8").into()
}

/// An input, whose language decides later what a text that is not UTF-8 is.
pub(crate) fn read_input(path: &str) -> Result<Source, Diagnostics> {
    let name = if path == "-" { "<stdin>" } else { path };
    Ok(Source::decode(name, read_bytes(path)?))
}

/// Loads the files that an input names, from where it stands itself; those of standard input from the current folder.
pub(crate) fn load_named(language: &Language, sources: &mut Sources) {
    let Some(input) = sources.get(SourceId::INPUT) else { return };
    let folder = Path::new(&input.name).parent().map(Path::to_owned).unwrap_or_default();
    for name in (language.files)(input) {
        if sources.named(&name).is_some() {
            continue;
        }
        let path = folder.join(&name);
        let bytes = if path.is_dir() {
            Err("it is a directory".to_owned())
        } else {
            match read_file(&path) {
                Ok(bytes) => bytes.ok_or_else(|| format!("it is {}", too_large())),
                Err(error) => Err(error.to_string()),
            }
        };
        sources.name(&name, bytes.map(|bytes| Source::decode(path.display().to_string(), bytes)));
    }
}

/// Whether a file is one of those that were read.
pub(crate) fn is_read(path: &str, sources: &Sources) -> bool {
    sources.paths().any(|read| same_file(path, read))
}

/// A file as a named text.
pub(crate) fn read_source(path: &str) -> Result<Source, Diagnostics> {
    let name = if path == "-" { "<stdin>" } else { path };
    Ok(Source::new(name, read_text(path)?))
}

/// Writes to standard output. Whoever reads may have seen enough: a broken pipe is no error.
pub(crate) fn print(text: &str) -> Result<(), Diagnostics> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        written => written
            .context("cannot write to standard output")
            .map_err(|error| failed("output-failed", &error)),
    }
}

/// Whether two paths are one file, whether it is there already or not.
pub(crate) fn same_file(a: &str, b: &str) -> bool {
    // A path that leads nowhere is told of where it is written to.
    a != "-" && b != "-" && whole(a).is_some_and(|a| whole(b).is_some_and(|b| a == b))
}

/// The one path of a file: without links, `.` and `..`, as far as there are folders.
fn whole(path: &str) -> Option<PathBuf> {
    let target = followed(Path::new(path)).ok()?;
    if let Ok(known) = fs::canonicalize(&target) {
        return Some(known);
    }
    Some(fs::canonicalize(folder_of(&target)).ok()?.join(target.file_name()?))
}

/// The folder that a file stands in.
fn folder_of(target: &Path) -> &Path {
    target.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Links that lead on farther than this lead in a circle.
const MOST_LINKS: usize = 40;

/// Writes a file beside its target and renames it, so that it is there whole or not at all. Its mode is kept, links are
/// followed, a device or pipe is written directly.
pub(crate) fn write_file(path: &str, text: &str) -> Result<(), Diagnostics> {
    write_files(&[(path, text)])
}

/// Writes files, all or none of them: each beside its target first, then all are renamed. `-` is standard output; that and
/// devices come last, since nothing takes back what they got.
pub(crate) fn write_files(files: &[(&str, &str)]) -> Result<(), Diagnostics> {
    let said = |path: &str, error: anyhow::Error| {
        failed("output-failed", &error.context(format!("cannot write {path}")))
    };
    let mut waiting = Vec::new();
    for (path, text) in files {
        if *path == "-" {
            waiting.push((*path, Staged::Print(text)));
            continue;
        }
        if path.is_empty() {
            return Err(Diagnostic::error("output-failed", "the output file has no name").into());
        }
        if Path::new(path).is_dir() {
            return Err(Diagnostic::error("file-is-directory", format!("{path} is a directory")).into());
        }
        let alone = files.len() == 1;
        let staged = followed(Path::new(path)).and_then(|target| Staged::new(target, text, alone));
        waiting.push((*path, staged.map_err(|error| said(path, error))?));
    }
    waiting.sort_by_key(|(_, staged)| match staged {
        Staged::Beside { .. } => 0,
        Staged::Device(..) => 1,
        Staged::Print(_) => 2,
    });
    let mut done: Vec<Undo> = Vec::new();
    for (path, staged) in waiting {
        let placed = match staged {
            Staged::Beside { target, file, undo } => file
                .persist(&target)
                .map(|_| done.push(undo))
                .map_err(|error| io::Error::from(error.error.kind()))
                .context("the new file cannot take its place")
                .map_err(|error| said(path, error)),
            Staged::Device(target, text) => {
                fs::write(&target, text).map_err(|error| said(path, error.into()))
            }
            Staged::Print(text) => print(text),
        };
        if let Err(error) = placed {
            done.into_iter().for_each(Undo::undo);
            return Err(error);
        }
    }
    Ok(())
}

/// Where a path leads through its links; the last of them may lead to a file that is not there yet.
fn followed(path: &Path) -> anyhow::Result<PathBuf> {
    if let Ok(target) = fs::canonicalize(path) {
        return Ok(target);
    }
    let mut target = path.to_owned();
    for _ in 0..MOST_LINKS {
        let Ok(next) = fs::read_link(&target) else { return Ok(target) };
        target = target.parent().unwrap_or(Path::new("")).join(next);
    }
    anyhow::bail!("it is a link that leads nowhere")
}

/// A text that waits beside its target; that of a device or of standard output waits here.
enum Staged<'t> {
    Beside { target: PathBuf, file: tempfile::NamedTempFile, undo: Undo },
    Device(PathBuf, &'t str),
    Print(&'t str),
}

/// How a file that took its place is taken back.
enum Undo {
    /// Not: it is the only one, or what stood there may not be read.
    Nothing,
    /// There was none.
    Remove(PathBuf),
    /// What stood there.
    Restore(PathBuf, Vec<u8>),
}

impl Undo {
    /// Takes it back; where the system refuses even that, the first refusal is what is told.
    fn undo(self) {
        let _ = match self {
            Undo::Nothing => Ok(()),
            Undo::Remove(target) => fs::remove_file(target),
            Undo::Restore(target, bytes) => fs::write(target, bytes),
        };
    }
}

impl<'t> Staged<'t> {
    /// Puts a text beside its target. `alone`: no other file has to be taken back with it.
    fn new(target: PathBuf, text: &'t str, alone: bool) -> anyhow::Result<Staged<'t>> {
        let old = fs::metadata(&target).ok();
        if old.as_ref().is_some_and(|old| !old.is_file()) {
            return Ok(Staged::Device(target, text));
        }
        // A file that may not be written to is not replaced behind its owner's back.
        if old.is_some() {
            fs::OpenOptions::new().write(true).open(&target)?;
        }
        // Of an error the kind alone: its text may name the file beside the target.
        let plain = |error: io::Error| io::Error::from(error.kind());
        let folder = folder_of(&target);
        anyhow::ensure!(folder.is_dir(), "there is no folder {}", folder.display());
        let beside = || format!("no new file can stand in {}", folder.display());
        let mut builder = tempfile::Builder::new();
        #[cfg(unix)]
        if old.is_none() {
            use std::os::unix::fs::PermissionsExt;
            // As `open` makes files: the umask takes its share.
            builder.permissions(fs::Permissions::from_mode(0o666));
        }
        let mut file =
            builder.prefix(".splinepost-").tempfile_in(folder).map_err(plain).with_context(beside)?;
        file.write_all(text.as_bytes()).map_err(plain)?;
        if let Some(old) = &old {
            file.as_file()
                .set_permissions(old.permissions())
                .map_err(plain)
                .context("its mode cannot be kept")?;
        }
        file.as_file().sync_all().map_err(plain)?;
        let undo = match old {
            _ if alone => Undo::Nothing,
            None => Undo::Remove(target.clone()),
            Some(_) => fs::read(&target).map_or(Undo::Nothing, |bytes| Undo::Restore(target.clone(), bytes)),
        };
        Ok(Staged::Beside { target, file, undo })
    }
}
