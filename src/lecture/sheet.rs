//! What a chapter is written on: paragraphs, equations, rows of pictures, tables, commands, in both languages at once.

use super::math;
use super::text::{Text, text};
use crate::error::{Error, Result};
use crate::image::{Image, png_of};
use crate::report::chart::{Chart, Guide, Series, Spot, Through, describe, key};
use crate::report::html::escape;
use crate::report::number::figure;
use crate::report::pictures::Pictures;
use crate::statistics::Interval;

/// A picture with what stands above and below it.
pub struct Cell {
    /// Its file's name within the page.
    pub name: String,
    /// The picture, as it is to be seen.
    pub image: Image,
    /// Its title.
    pub title: Text,
    /// What it shows, plainly, for those who do not see it.
    pub alt: Text,
    /// Figures below it.
    pub caption: Vec<Text>,
}

/// A curve: its name and its points.
pub struct Curve {
    /// Its name.
    pub name: Text,
    /// Its points.
    pub points: Vec<(f64, f64)>,
}

/// A page in the making.
#[derive(Default)]
pub struct Sheet {
    html: String,
    pictures: Pictures,
}

impl Sheet {
    /// The chapters' HTML and the pictures that it shows.
    pub fn into_parts(self) -> (String, Pictures) {
        (self.html, self.pictures)
    }

    /// HTML that is alike in both languages.
    pub fn raw(&mut self, html: &str) {
        self.html += html;
    }

    /// What the chapter asks.
    pub fn question(&mut self, question: Text) {
        self.html += &question.within("p class=\"question\"");
        self.html.push('\n');
    }

    /// A paragraph.
    pub fn say(&mut self, paragraph: Text) {
        self.html += &paragraph.within("p class=\"prose\"");
        self.html.push('\n');
    }

    /// A heading within a chapter.
    pub fn heading(&mut self, heading: Text) {
        self.html += &heading.within("h3");
        self.html.push('\n');
    }

    /// What to look for in the pictures above.
    pub fn see(&mut self, what: Text) {
        let labelled = text(
            format!("<strong>What to see.</strong> {}", what.en),
            format!("<strong>Qué se ve.</strong> {}", what.es),
        );
        self.html += &labelled.within("p class=\"prose see\"");
        self.html.push('\n');
    }

    /// An equation with what its symbols mean.
    pub fn equation(&mut self, source: &str, meaning: Text) {
        self.html += &format!("<div class=\"equation\">{}</div>\n", math::display(source));
        self.html += &meaning.within("p class=\"prose quiet\"");
        self.html.push('\n');
    }

    /// Pictures beside each other, at most so many in a row.
    pub fn gallery(&mut self, columns: usize, cells: Vec<Cell>, note: Text) -> Result<()> {
        self.html += &format!("<div class=\"cells\" style=\"--columns: {columns}\">\n");
        for cell in cells {
            self.cell(&cell)?;
        }
        self.html += &format!("</div>\n{}\n", note.within("p class=\"quiet note\""));
        Ok(())
    }

    /// One picture.
    fn cell(&mut self, cell: &Cell) -> Result<()> {
        self.add_picture(cell)?;
        let shown = self.show(cell);
        let caption: String = cell.caption.iter().map(|line| line.within("span")).collect();
        self.html += &format!(
            "<figure class=\"cell\">\n{}\n<div class=\"views\">{shown}</div>\n<figcaption>{caption}</figcaption>\n</figure>\n",
            cell.title.within("h4")
        );
        Ok(())
    }

    fn add_picture(&mut self, cell: &Cell) -> Result<()> {
        let failed = |cause: String| Error::write(format!("{}.png", cell.name).as_ref(), cause);
        let png = png_of(&cell.image).map_err(failed)?;
        self.pictures.insert(&cell.name, (cell.image.width, cell.image.height), &png);
        Ok(())
    }

    fn show(&self, cell: &Cell) -> String {
        cell.alt.map(|alt| self.pictures.show(&cell.name, alt)).inline()
    }

    /// Rows of pictures that form a triangle: one row for each path length.
    pub fn pyramid(&mut self, rows: Vec<Vec<Cell>>, note: Text) -> Result<()> {
        let widest = rows.iter().map(Vec::len).max().unwrap_or(1);
        self.html += &format!("<div class=\"scroll\"><div class=\"pyramid\" style=\"--columns: {widest}\">\n");
        for row in rows {
            self.html += "<div class=\"step\">\n";
            for cell in row {
                self.cell(&cell)?;
            }
            self.html += "</div>\n";
        }
        self.html += &format!("</div></div>\n{}\n", note.within("p class=\"quiet note\""));
        Ok(())
    }

    /// What the colours of a map of differences mean.
    pub fn map_legend(&mut self, scale: f64, note: Text) {
        let percent = figure_of_percent(scale);
        let meaning = text(
            format!(
                "relative difference from the reference: blue too dark, red too bright, full colour from {percent} on. {}",
                note.en
            ),
            format!(
                "diferencia relativa con la referencia: azul, demasiado oscuro; rojo, demasiado claro; color pleno desde {percent}. {}",
                note.es
            ),
        );
        self.html += &format!(
            "<p class=\"scale\"><span>−{percent}</span> <span class=\"ramp\"></span> <span>+{percent}</span> {}</p>\n",
            meaning.within("span class=\"quiet\"")
        );
    }

    /// A table; the first column names its rows.
    pub fn table(&mut self, heads: &[Text], rows: &[Vec<Text>]) {
        let head: String = heads.iter().map(|head| format!("<th scope=\"col\">{}</th>", head.inline())).collect();
        self.html += &format!("<div class=\"scroll\"><table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n");
        for row in rows {
            let cells = row.iter().enumerate().map(|(index, cell)| match index {
                0 => format!("<th scope=\"row\">{}</th>", cell.inline()),
                _ => format!("<td>{}</td>", cell.inline()),
            });
            self.html += &format!("<tr>{}</tr>\n", cells.collect::<String>());
        }
        self.html += "</tbody></table></div>\n";
    }

    /// Curves on two logarithmic axes, with a line of that slope beside them.
    pub fn chart(&mut self, axes: [Text; 2], alt: &Text, curves: &[Curve], guide: (f64, &Text)) {
        let exact = |value: f64| Interval { mean: value, low: value, high: value };
        let keys: String = curves
            .iter()
            .enumerate()
            .map(|(index, curve)| format!("<li>{} {}</li>", key(index), curve.name.inline()))
            .collect();
        self.html += &format!("<ul class=\"legend\">{keys}</ul>\n<div class=\"plots\">\n");
        for language in [0, 1] {
            let (lang, [x, y]) = (alt.both()[language].0, [&axes[0], &axes[1]].map(|axis| axis.both()[language].1));
            let series = curves.iter().enumerate().map(|(index, curve)| {
                let name = curve.name.both()[language].1;
                let spot = |(at, value): &(f64, f64)| Spot {
                    x: exact(*at),
                    y: exact(*value),
                    text: describe(name, &figure(*at), y, &exact(*value)),
                };
                Series { name, index, points: curve.points.iter().map(spot).collect(), floor: None }
            });
            let label = guide.1.both()[language].1;
            let chart = Chart {
                text: alt.both()[language].1.to_owned(),
                x,
                y,
                series: series.collect(),
                guide: Some(Guide { slope: guide.0, through: Through::BestEnd, label }),
                levels: Vec::new(),
            };
            self.html += &format!("<div lang=\"{lang}\">{}</div>\n", chart.draw());
        }
        self.html += "</div>\n";
    }

    /// The commands that made what stands above.
    pub fn commands(&mut self, commands: &[String]) {
        let title = match commands.len() {
            1 => text("The command", "La orden"),
            count => text(format!("The {count} commands"), format!("Las {count} órdenes")),
        };
        let open = if commands.len() <= 3 { " open=\"open\"" } else { "" };
        let lines = commands.iter().map(|command| escape(command)).collect::<Vec<_>>().join("\n");
        self.html += &format!(
            "<details class=\"commands\"{open}><summary>{}</summary>\n<pre><code>{lines}</code></pre></details>\n",
            title.inline()
        );
    }
}

/// A share as percent.
pub fn figure_of_percent(share: f64) -> String {
    format!("{} %", crate::report::number::trimmed((1000.0 * share).round() / 10.0))
}
