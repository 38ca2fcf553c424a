//! The lecture: a page with the comparisons of a course on global illumination, each made by the commands that it shows.
//!
//! A chapter is one file in `chapters/`: a function that asks the [`Lab`] for renderings and writes what came of them on a
//! [`Sheet`], in English and in Spanish. Figures come from what the commands wrote, never from the text.

mod chapter;
mod chapters;
mod command;
mod lab;
mod math;
mod page;
mod run;
mod sheet;
mod text;
mod view;

use crate::error::{Error, Result, one_of};
use crate::files::replace_by;

pub use chapter::{Chapter, Circumstances};
pub use chapters::CHAPTERS;
pub use command::Scale;
pub use lab::{Lab, Place};
pub use sheet::Sheet;
pub use text::{LANGUAGES, Text};

/// The chapters of these names in their order; all that there are where none is named.
pub fn choose(names: &[String]) -> Result<Vec<&'static Chapter>> {
    let there = || CHAPTERS.iter().filter(|chapter| chapter.is_there());
    if let Some(unknown) = names.iter().find(|name| there().all(|chapter| chapter.name != **name)) {
        let valid = one_of(there().map(|chapter| chapter.name));
        return Err(Error::Usage(format!("no chapter '{unknown}': valid are {valid}")));
    }
    Ok(there().filter(|chapter| names.is_empty() || names.iter().any(|name| chapter.name == name)).collect())
}

/// Makes the chapters and writes them as `index.html` into the lecture's folder.
pub fn write(chapters: &[&Chapter], lab: &mut Lab, circumstances: &Circumstances) -> Result<()> {
    let mut sheet = Sheet::default();
    for (index, chapter) in chapters.iter().enumerate() {
        lab.say(&format!("{} of {}: {}", index + 1, chapters.len(), chapter.titles.0));
        sheet.raw(&page::open_chapter(index + 1, chapter));
        (chapter.write)(lab, &mut sheet)?;
        sheet.raw("</section>\n");
    }
    let page = page::page(chapters, sheet, circumstances, lab.took());
    replace_by(&lab.page(), page.as_bytes())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::techniques;

    #[test]
    fn chapters_have_names_of_their_own_and_need_known_techniques() {
        let mut names: Vec<&str> = CHAPTERS.iter().map(|chapter| chapter.name).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), CHAPTERS.len());
        for needed in CHAPTERS.iter().flat_map(|chapter| chapter.needs) {
            assert!(techniques::find(needed).is_some(), "no technique {needed}");
        }
        assert_eq!(choose(&[]).unwrap().len(), CHAPTERS.iter().filter(|chapter| chapter.is_there()).count());
        let error = choose(&[String::from("nothing")]).err().unwrap().to_string();
        assert!(error.contains("no chapter 'nothing'") && error.contains(CHAPTERS[0].name), "{error}");
    }
}
