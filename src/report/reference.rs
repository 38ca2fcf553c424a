//! What a scene's images were compared with: who made it, how large its own error is, and what an independent technique says of it.

use super::html::{escape, fact};
use super::number;
use super::pictures::Pictures;
use super::summary::WARNING;
use crate::bench::results::{Reference, SceneResults};
use crate::reference::{Certificate, Maker, Pilot, Witness};

/// Deviations that full colour of the difference map stands for.
const MAP_SCALE: f64 = 6.0;
/// A witness that overlooks larger relative differences in half of the tiles confirms a reference only roughly.
const ROUGH: f64 = 0.1;
/// Below this the tail of a reference's noise is so heavy that its variance may be infinite.
const FINITE_VARIANCE: f64 = 2.0;

/// What the scene's reference is known to be off by, as a relMSE, and whether it is at least that.
pub struct Own {
    /// Its noise, and the blur that it may have.
    pub relmse: f64,
    /// Whether few bright samples decide it, so that it may be more.
    pub at_least: bool,
}

impl Own {
    /// That of a reference; nothing where nobody knows.
    pub fn of(reference: &Reference) -> Option<Self> {
        let found = match &reference.certificate {
            Some(Certificate { error, .. }) => {
                Self { relmse: error.relmse.mean + error.bias, at_least: error.at_least }
            }
            None => Self { relmse: reference.relmse?, at_least: false },
        };
        (found.relmse.is_finite() && found.relmse > 0.0).then_some(found)
    }
}

/// The part of the page on the reference.
pub fn section(scene: &SceneResults, pictures: &Pictures) -> String {
    let reference = &scene.reference;
    let map = reference.difference_map.as_ref().map_or_else(String::new, |map| {
        format!(
            "<figure>\n{}\n<figcaption><strong>Where the witness differs</strong>: red where it is brighter, blue where it is darker; full \
             colour is {MAP_SCALE:.0} deviations of the mean of a tile of 4 × 4 pixels and beyond.</figcaption>\n</figure>\n",
            pictures.show(map, &format!("where the witness differs from the reference of {}", scene.name))
        )
    });
    let certificate = reference.certificate.as_ref();
    let facts = certificate.map_or_else(|| plain_facts(reference), |certificate| facts(reference, certificate));
    format!(
        "<h3>The reference</h3>\n<div class=\"reference\">\n<figure>\n{}\n<figcaption><strong>Reference</strong> \
         <code>{}</code></figcaption>\n</figure>\n{map}<div class=\"known\">\n{}<dl class=\"facts\">\n{facts}</dl>\n</div>\n</div>\n{}",
        pictures.show(&reference.picture, &format!("the reference of {}", scene.name)),
        escape(&reference.image),
        standing(reference),
        certificate.map_or_else(String::new, pilots) + &certificate.map_or_else(String::new, differences),
    )
}

/// Whether it is confirmed.
fn standing(reference: &Reference) -> String {
    match &reference.doubt {
        Some(doubt) => {
            format!("<p><strong class=\"doubt\">{WARNING} Not confirmed: {}.</strong></p>\n", escape(doubt))
        }
        None => match reference.certificate.as_ref().and_then(|certificate| certificate.witness.as_ref()) {
            Some(witness) if witness.detectable > ROUGH => format!(
                "<p><strong>Confirmed roughly</strong>: the witness, {}, sees no difference, but would have overlooked one of {} % in half \
                 of the tiles of 16 × 16 pixels.</p>\n",
                escape(&witness.technique),
                number::figure(100.0 * witness.detectable)
            ),
            Some(witness) => format!(
                "<p><strong class=\"confirmed\">Confirmed</strong> by an independent technique, {}.</p>\n",
                escape(&witness.technique)
            ),
            None => String::from("<p><strong class=\"confirmed\">Confirmed</strong>.</p>\n"),
        },
    }
}

fn origin(reference: &Reference) -> String {
    match reference.origin.as_str() {
        "made" => String::from("made for this bench"),
        "cached" => String::from("made by an earlier bench"),
        other => match other.strip_prefix("given: ") {
            Some(file) => format!("given: <code>{}</code>", escape(file)),
            None => escape(other),
        },
    }
}

/// The facts of a reference of which only its noise may be known.
fn plain_facts(reference: &Reference) -> String {
    let own = match reference.relmse {
        Some(relmse) => format!("relMSE {}, taken off all errors", number::figure(relmse)),
        None => String::from("not known; it stays in all errors"),
    };
    let technique = reference.technique.as_deref().unwrap_or("nobody knows what");
    let spp = reference.spp.map_or_else(String::new, |spp| format!(", {} spp", number::whole(spp)));
    fact("Origin", &origin(reference))
        + &fact("Made by", &format!("{}{spp}", escape(technique)))
        + &fact("Own error", &own)
        + &fact("Witness", "none")
}

fn facts(reference: &Reference, certificate: &Certificate) -> String {
    let took = format!(
        "{} s, of these {} s to choose the technique",
        number::figure(certificate.seconds),
        number::figure(certificate.pilot_seconds)
    );
    let makers: Vec<String> = certificate.makers.iter().map(|maker| made(maker, certificate.makers.len())).collect();
    let makers = if makers.is_empty() { String::from("not known") } else { makers.join("<br/>") };
    let error = &certificate.error;
    let tail = match error.tail_index {
        Some(index) if index < FINITE_VARIANCE => {
            format!("; its tail has the index {index:.1}, so its variance may be infinite")
        }
        Some(index) => format!("; its tail has the index {index:.1}"),
        None => String::new(),
    };
    let own = format!(
        "{} <small class=\"quiet\">A thousandth of the values makes {:.0} % of it{tail}.</small>",
        escape(&certificate.error_in_words()),
        100.0 * error.largest_share
    );
    let witness = certificate.witness.as_ref().map_or_else(|| String::from("none could be asked"), witness);
    fact("Origin", &origin(reference))
        + &fact("Made by", &makers)
        + &fact("Took", &took)
        + &fact("Own error", &own)
        + &fact("Witness", &witness)
        + &certificate.others.iter().map(|other| fact("Also asked", &self::witness(other))).collect::<String>()
}

fn made(maker: &Maker, of: usize) -> String {
    let share = if of > 1 { format!(", {:.0} % of the image", 100.0 * maker.share) } else { String::new() };
    format!(
        "{}, {} spp, {} s{share}{}",
        escape(&maker.technique),
        number::samples(maker.spp.round()),
        number::figure(maker.seconds),
        chance(maker.by_chance.as_deref())
    )
}

fn chance(what: Option<&str>) -> String {
    what.map_or_else(String::new, |what| format!("; finds {} only with rare, bright samples", escape(what)))
}

/// What an independent technique says, in a sentence or two.
fn witness(witness: &Witness) -> String {
    let tests = number::whole(witness.tests);
    let found = match witness.differences.len() {
        0 => format!("no difference beyond noise in {tests} tests"),
        1 => format!("differs beyond noise in one place, of {tests} tests"),
        count => format!("differs beyond noise in {count} places, of {tests} tests"),
    };
    let unseen = match witness.unseen {
        0 => String::new(),
        1 => String::from(
            " In one of them it lacks light that it finds only with rare, bright samples, which says nothing against the reference.",
        ),
        count => format!(
            " In {} of them it lacks light that it finds only with rare, bright samples, which says nothing against the reference.",
            number::whole(count)
        ),
    };
    format!(
        "{}, {} spp, {} s: <strong>{found}</strong>.{unseen} In half of the tiles of 16 × 16 pixels it would have seen a difference of {} %{}.",
        escape(&witness.technique),
        number::samples(witness.spp.round()),
        number::figure(witness.seconds),
        number::figure(100.0 * witness.detectable),
        chance(witness.by_chance.as_deref())
    )
}

/// A table; its first column names the rows. All is HTML but the heads.
fn table(label: &str, heads: &[&str], rows: impl Iterator<Item = Vec<String>>) -> String {
    let head: String =
        heads.iter().map(|head| format!("<th scope=\"col\" role=\"columnheader\">{}</th>", escape(head))).collect();
    let row = |cells: Vec<String>| {
        let cells = heads.iter().zip(cells).enumerate().map(|(index, (head, cell))| match index {
            0 => format!("<th scope=\"row\" role=\"rowheader\"><div>{cell}</div></th>"),
            _ => format!("<td role=\"cell\" data-label=\"{}\"><div>{cell}</div></td>", escape(head)),
        });
        format!("<tr role=\"row\">{}</tr>\n", cells.collect::<String>())
    };
    format!(
        "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"{}\">\n<table class=\"worded\" role=\"table\">\n\
         <thead role=\"rowgroup\"><tr role=\"row\">{head}</tr></thead>\n<tbody role=\"rowgroup\">\n{}</tbody>\n</table>\n</div>\n",
        escape(label),
        rows.map(row).collect::<String>()
    )
}

/// The techniques that were tried.
fn pilots(certificate: &Certificate) -> String {
    if certificate.pilots.is_empty() {
        return String::new();
    }
    let row = |pilot: &Pilot| {
        let is_maker = certificate.makers.iter().any(|maker| maker.technique == pilot.technique);
        let is_witness = certificate.witness.as_ref().is_some_and(|witness| witness.technique == pilot.technique);
        let role = match (is_maker, is_witness) {
            (true, true) => " <small class=\"mark\">made a part, and was the witness</small>",
            (true, false) => " <small class=\"mark\">made it</small>",
            (false, true) => " <small class=\"mark\">was the witness</small>",
            (false, false) => "",
        };
        vec![
            format!("{}{role}", escape(&pilot.technique)),
            number::figure(pilot.seconds),
            number::figure(pilot.noise),
            number::figure(pilot.lacking),
            pilot.by_chance.as_deref().map_or_else(|| String::from("–"), escape),
        ]
    };
    let heads = ["Technique", "Seconds", "Noise, relMSE × s", "Lacking, relMSE", "Finds only with rare samples"];
    format!(
        "<details>\n<summary>Techniques that were tried for it</summary>\n<p class=\"quiet\">Noise is what more samples take away: less \
         is better. Lacking is what they do not: blur, or light that the technique did not find and another one did.</p>\n{}</details>\n",
        table("Techniques that were tried", &heads, certificate.pilots.iter().map(row))
    )
}

/// The mean of a tile, with digits enough to see small differences.
fn mean(value: f64) -> String {
    if value.abs() < 0.01 { number::figure(value) } else { format!("{value:.4}").replace('-', "−") }
}

/// Where its witness, and others that were asked, differ from it.
fn differences(certificate: &Certificate) -> String {
    let all: Vec<&Witness> = certificate.witness.iter().chain(&certificate.others).collect();
    let rows = all.iter().flat_map(|witness| {
        witness.differences.iter().map(|found| {
            vec![
                format!("({}, {}) of {} × {}", found.x, found.y, found.width, found.height),
                escape(&witness.technique),
                mean(found.reference),
                mean(found.witness),
                format!("{:.1}", found.deviations).replace('-', "−"),
                escape(&found.likely),
            ]
        })
    });
    let rows: Vec<Vec<String>> = rows.collect();
    if rows.is_empty() {
        return String::new();
    }
    let heads = ["Tile, pixels", "Against", "Reference", "The other", "Deviations", "Likely"];
    format!(
        "<details open=\"open\">\n<summary>Where it differs from other techniques</summary>\n<p class=\"quiet\">Means of the channel that \
         differs most, the clearest place of each technique first; deviations are positive where the other one is brighter.</p>\n\
         {}</details>\n",
        table("Where the reference differs", &heads, rows.into_iter())
    )
}
