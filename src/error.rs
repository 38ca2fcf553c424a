//! What can go wrong, each with a message of one line that names the file, the element, the device or the result at
//! fault, and says what is valid.

use std::fmt;
use std::path::{Path, PathBuf};

/// The result of anything in this crate that can fail.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// What went wrong.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The command asks for something that does not exist or makes no sense.
    #[error("{0}")]
    Usage(String),

    /// A scene file, or a file that it names, is wrong.
    #[error("{}{}: {message}", plain(file.display()), place)]
    Scene {
        /// The file at fault.
        file: PathBuf,
        /// Where in it.
        place: Place,
        /// What is wrong and what is valid.
        message: String,
    },

    /// A file could not be read or written.
    #[error("cannot {doing} {}: {cause}", plain(file.display()))]
    File {
        /// `read`, `write`, ...
        doing: &'static str,
        /// The file.
        file: PathBuf,
        /// The system's reason.
        cause: String,
    },

    /// No device of this machine can do what is asked.
    #[error("{0}")]
    Device(String),

    /// A rendering has found nothing to go on with.
    #[error("{0}")]
    NothingFound(String),

    /// A Vulkan call failed.
    #[error("Vulkan failed to {doing}: {code}")]
    Vulkan {
        /// What was being done, and with what.
        doing: String,
        /// The `VkResult`.
        code: String,
    },

    /// The device has no room.
    #[error("out of device memory: {what} needs {}, and {} are in use{limit}", Bytes(*needs), Bytes(*in_use))]
    OutOfMemory {
        /// The name of what was to be allocated.
        what: String,
        /// Its size in bytes.
        needs: u64,
        /// Bytes that lumbre holds on the device.
        in_use: u64,
        /// The limit that was met, as text that ends the message.
        limit: String,
    },

    /// The device stopped answering.
    #[error("the device {device} was lost during {pass}: {work}")]
    DeviceLost {
        /// The device's name.
        device: String,
        /// The pass that ran.
        pass: String,
        /// What it was given to do.
        work: String,
    },

    /// The image could not be denoised.
    #[error("Open Image Denoise: {0}")]
    Denoise(String),

    /// A rendering ended before its time; what is left of it.
    #[error("{cause}; {kept}")]
    Stopped {
        /// What ended it.
        cause: Box<Error>,
        /// What is kept, and how to go on.
        kept: String,
    },

    /// The user stopped it; the text says what is kept.
    #[error("interrupted: {0}")]
    Interrupted(String),

    /// A command that a lecture runs failed.
    #[error("the command failed: {command}: {message}")]
    Command {
        /// The command, as one types it.
        command: String,
        /// What it said.
        message: String,
    },

    /// A bench found something worse than before.
    #[error("{0}")]
    Regression(String),

    /// A figure of the accuracy suite is beyond its bound.
    #[error("beyond their bounds: {0}")]
    Verification(String),

    /// Another renderer, in a bench, failed.
    #[error("peer {name}: {message}")]
    Peer {
        /// Its name, or the command that started it.
        name: String,
        /// What is wrong.
        message: String,
    },

    /// A Vulkan validation message, where validation was asked for.
    #[error("Vulkan validation: {0}")]
    Validation(String),
}

impl Error {
    /// The process's exit status: 2 where the command or the scene is wrong, 1 where the work failed.
    pub fn exit_status(&self) -> u8 {
        match self {
            Error::Usage(_) | Error::Scene { .. } | Error::File { doing: "read", .. } => 2,
            _ => 1,
        }
    }

    /// An error about a file as a whole.
    pub fn scene(file: &Path, message: impl Into<String>) -> Self {
        Error::Scene { file: file.to_owned(), place: Place::None, message: plain(message.into()) }
    }

    /// An error about one line of a file.
    pub fn scene_line(file: &Path, line: u32, message: impl Into<String>) -> Self {
        Error::Scene { file: file.to_owned(), place: Place::Line(line), message: plain(message.into()) }
    }

    /// A failure to read a file.
    pub fn read(file: &Path, cause: impl fmt::Display) -> Self {
        Error::File { doing: "read", file: file.to_owned(), cause: plain(cause) }
    }

    /// A failure to write a file.
    pub fn write(file: &Path, cause: impl fmt::Display) -> Self {
        Error::File { doing: "write", file: file.to_owned(), cause: cause.to_string() }
    }
}

/// Where in a file something is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// The file as a whole.
    None,
    /// A line, counted from 1.
    Line(u32),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::None => Ok(()),
            Place::Line(line) => write!(f, ":{line}"),
        }
    }
}

/// A number of bytes, shown in binary units.
#[derive(Clone, Copy, Debug)]
pub struct Bytes(pub u64);

impl fmt::Display for Bytes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            0..1024 => write!(f, "{} B", self.0),
            1024..1_048_576 => write!(f, "{:.1} KiB", self.0 as f64 / 1024.0),
            1_048_576..1_073_741_824 => write!(f, "{:.1} MiB", self.0 as f64 / 1_048_576.0),
            _ => write!(f, "{:.2} GiB", self.0 as f64 / 1_073_741_824.0),
        }
    }
}

/// The most characters of a message: files can make lists and names of any length.
const MAX_MESSAGE: usize = 2000;

/// Text that may come from a file, for a message: one line, without control characters, its middle left out where it is long.
pub(crate) fn plain(text: impl fmt::Display) -> String {
    let text = text.to_string();
    let text = text.trim_end();
    if text.len() <= MAX_MESSAGE && !text.contains(char::is_control) {
        return text.to_owned();
    }
    let mut out: Vec<char> = Vec::new();
    for c in text.chars() {
        if c.is_control() { out.extend(c.escape_default()) } else { out.push(c) }
    }
    let Some(extra) = out.len().checked_sub(MAX_MESSAGE) else { return out.into_iter().collect() };
    let (head, tail) = (&out[..MAX_MESSAGE / 2], &out[MAX_MESSAGE / 2 + extra..]);
    [head, &[' ', '.', '.', '.', ' '], tail].concat().into_iter().collect()
}

/// "a, b and c", for messages that list what there is.
pub fn all_of<S: AsRef<str>>(names: impl IntoIterator<Item = S>) -> String {
    join(names, "and")
}

/// "a, b or c", for messages that list what is valid.
pub fn one_of<S: AsRef<str>>(names: impl IntoIterator<Item = S>) -> String {
    join(names, "or")
}

/// Names that [`some_of`] lists at most.
const SOME: usize = 4;
/// More names than this are counted and not looked through for those that are alike.
const COMPARED: usize = 1 << 11;

/// "a, b and c", for messages about a name that is not among those that there are: all of a few, else their number and the few that are
/// most like it. `what` says what they are: "ids".
pub(crate) fn some_of<'a>(names: impl IntoIterator<Item = &'a str>, what: &str, wanted: &str) -> String {
    let names = names.into_iter();
    if names.size_hint().0 > COMPARED {
        return format!("{} {what}", names.count());
    }
    let mut names: Vec<&str> = names.collect();
    names.sort_unstable();
    match names.len() {
        0 => String::from("none"),
        1..=SOME => all_of(names),
        count => {
            names.sort_by_cached_key(|name| difference(name, wanted));
            format!("{count} {what}, such as {}", all_of(&names[..SOME]))
        }
    }
}

/// The least number of letters to change, add or take away that makes one name of another (Levenshtein), whatever their case, by their first
/// letters.
fn difference(a: &str, b: &str) -> usize {
    let letters = |text: &str| -> Vec<char> { text.chars().take(32).map(|c| c.to_ascii_lowercase()).collect() };
    let (a, b) = (letters(a), letters(b));
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.iter().enumerate() {
        let mut diagonal = std::mem::replace(&mut row[0], i + 1);
        for (j, y) in b.iter().enumerate() {
            let least = (diagonal + usize::from(x != y)).min(row[j] + 1).min(row[j + 1] + 1);
            diagonal = std::mem::replace(&mut row[j + 1], least);
        }
    }
    row[b.len()]
}

fn join<S: AsRef<str>>(names: impl IntoIterator<Item = S>, word: &str) -> String {
    let names: Vec<String> = names.into_iter().map(|name| name.as_ref().to_owned()).collect();
    match names.split_last() {
        None => String::from("nothing"),
        Some((only, [])) => only.clone(),
        Some((last, rest)) => format!("{} {word} {last}", rest.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_many_names_the_nearest_are_listed() {
        assert_eq!(some_of([], "ids", "a"), "none");
        assert_eq!(some_of(["b", "a"], "ids", "c"), "a and b");
        let many: Vec<String> = (0..900).map(|index| format!("shape{index:03}")).collect();
        let of = |wanted: &str| some_of(many.iter().map(String::as_str), "ids", wanted);
        assert_eq!(of("Shape12"), "900 ids, such as shape012, shape102, shape112 and shape120");
        assert_eq!(difference("kitten", "Sitting"), 3);
        assert_eq!((difference("", "abc"), difference("abc", ""), difference("abc", "abc")), (3, 3, 0));
        assert_eq!(some_of([""; COMPARED + 1], "ids", "shape1"), "2049 ids");
    }

    #[test]
    fn messages_are_one_short_line() {
        assert_eq!(plain("as it is: é"), "as it is: é");
        assert_eq!(plain("an end of line\n"), "an end of line");
        assert_eq!(plain("two\nlines\u{1b}[31m"), "two\\nlines\\u{1b}[31m");
        let long = plain("é".repeat(5000) + "the end");
        assert!(long.chars().count() == MAX_MESSAGE + 5 && long.ends_with("the end") && long.contains(" ... "));
        let error = Error::scene(Path::new("a\nb.xml"), "c\td");
        assert_eq!(error.to_string(), "a\\nb.xml: c\\td");
    }
}
