//! Russian roulette against a fixed depth: bias as a map, cost as figures.

use super::prelude::*;
use super::scenes::CORNELL;
use crate::lecture::math::inline;
use crate::lecture::view;

pub const CHAPTER: Chapter = Chapter {
    name: "roulette",
    titles: ("Russian roulette against fixed depth", "Ruleta rusa frente a profundidad fija"),
    needs: &["path", "path-implicit"],
    write,
};

/// Longest paths, in segments.
const DEPTHS: [u32; 5] = [2, 3, 4, 6, 10];
/// Probabilities that a path ends at a vertex.
const ENDINGS: [&str; 4] = ["0.05", "0.1", "0.3", "0.6"];
/// Maps average blocks of so many pixels, and are in full colour from this difference on.
const BLOCK: u32 = 4;
const FULL: f64 = 0.5;
/// Samples per pixel.
const SAMPLES: u32 = 512;

fn write(lab: &mut Lab, sheet: &mut Sheet) -> Result<()> {
    sheet.question(text(
        "Paths must end somewhere. What does it cost to cut them off, and what to let chance decide?",
        "Los caminos tienen que acabar en algún sitio. ¿Qué cuesta cortarlos, y qué cuesta dejarlo al azar?",
    ));
    sheet.equation(
        "E [ L ′ ] = ( 1 − q ) · { L } over { 1 − q } + q · 0 = L",
        text(
            format!(
                "Russian roulette: with probability q the path ends and contributes nothing more, otherwise what follows counts {} times. The \
                 expectation stays, only the variance grows. Cutting at a fixed depth changes the expectation.",
                inline("1 / ( 1 − q )")
            ),
            format!(
                "Ruleta rusa: con probabilidad q el camino acaba y no aporta nada más; si no, lo que sigue cuenta {} veces. La esperanza \
                 se mantiene y solo crece la varianza. Cortar a una profundidad fija cambia la esperanza.",
                inline("1 / ( 1 − q )")
            ),
        ),
    );
    fixed_depth(lab, sheet)?;
    constant(lab, sheet)
}

/// Explicit paths that are cut off, and paths that roulette ends.
fn fixed_depth(lab: &mut Lab, sheet: &mut Sheet) -> Result<()> {
    let reference = CORNELL.reference(lab)?;
    let mut variants: Vec<(String, Text, String)> = DEPTHS
        .iter()
        .map(|depth| {
            let title = text(format!("cut at {depth} segments"), format!("cortado a los {depth} segmentos"));
            (format!("roulette-depth-{depth}"), title, format!("--max-depth {depth} --rr-depth 1000"))
        })
        .collect();
    variants.push((
        String::from("roulette-chance"),
        text("Russian roulette", "ruleta rusa"),
        String::from("--rr-depth 1"),
    ));
    let (mut cells, mut rows, mut spp) = (Vec::new(), Vec::new(), String::new());
    for (name, title, options) in variants {
        let run = lab.render(&name, CORNELL.shot("path").samples(SAMPLES).with(&options).with_errors())?;
        let found = lab.compare(&run, &reference)?;
        spp = samples(run.spp());
        let off = percent_off(relative(&run.mean()?, &reference.mean()?));
        let map = view::bias_map(&run.image, &reference.image, BLOCK, FULL);
        let alt = text(format!("map of its bias: {}", title.en), format!("mapa de su sesgo: {}", title.es));
        cells.push(Cell {
            name: format!("{name}-map"),
            image: map,
            title: title.clone(),
            alt: CORNELL.alt(&alt),
            caption: vec![of(&off, "")],
        });
        rows.push(vec![
            title,
            same(off),
            same(figure(run.rays_per_sample())),
            same(figure(run.seconds())),
            same(figure(found.relmse())),
        ]);
    }
    sheet.gallery(6, cells, same(""))?;
    sheet.map_legend(
        FULL,
        text(
            format!("Means of blocks of {BLOCK}×{BLOCK} pixels. Below each: the bias of the mean."),
            format!("Medias de bloques de {BLOCK}×{BLOCK} píxeles. Debajo de cada uno, el sesgo de la media."),
        ),
    );
    sheet.table(
        &[
            text(format!("explicit paths, {spp} spp"), format!("caminos explícitos, {spp} spp")),
            text("bias of the mean", "sesgo de la media"),
            text("rays per sample", "rayos por muestra"),
            text("seconds", "segundos"),
            same("relMSE"),
        ],
        &rows,
    );
    sheet.see(text(
        "What is cut off is missing where light arrives after many bounces: on the ceiling and in the shadows first. No number of \
         samples brings it back; a deeper cut does, at the price of more rays for paths that hardly carry light. Roulette has no colour in \
         its map, only grain, and asks for few rays.",
        "Lo que se corta falta donde la luz llega tras muchos rebotes: primero en el techo y en las sombras. Ningún número de muestras lo \
         devuelve; cortar más tarde sí, al precio de más rayos para caminos que apenas llevan luz. El mapa de la ruleta no tiene color, solo \
         grano, y pide pocos rayos.",
    ));
    sheet.commands(&lab.take_commands());
    Ok(())
}

/// Roulette with a constant probability, and the form that has none.
fn constant(lab: &mut Lab, sheet: &mut Sheet) -> Result<()> {
    sheet.heading(text("How often to end", "Con qué frecuencia acabar"));
    sheet.say(text(
        format!(
            "Implicit paths end at every vertex with the same probability q. A small q follows long paths for nothing; a large one ends most \
             paths early and lets the rest count for all of them. Where walls reflect the share ρ, the variance is even infinite for {}. The \
             biased form ends at the first lamp or after 8 segments.",
            inline("ρ ^ 2 ≥ 1 − q")
        ),
        format!(
            "Los caminos implícitos acaban en cada vértice con la misma probabilidad q. Una q pequeña sigue caminos largos para nada; una grande \
             corta casi todos y hace que los demás cuenten por todos. Si las paredes reflejan la fracción ρ, la varianza llega a ser infinita \
             para {}. La forma sesgada acaba en la primera lámpara o a los 8 segmentos.",
            inline("ρ ^ 2 ≥ 1 − q")
        ),
    ));
    let reference = CORNELL.reference(lab)?;
    let mut variants: Vec<(String, Text, &str, String)> = ENDINGS
        .iter()
        .map(|q| (format!("roulette-q-{q}"), same(format!("q = {q}")), "path-implicit", format!("--rr-q {q}")))
        .collect();
    let biased = text("biased form", "forma sesgada");
    variants.push((String::from("roulette-biased"), biased, "path-implicit:form=biased", String::new()));
    let (mut rows, mut spp) = (Vec::new(), String::new());
    for (name, title, technique, options) in variants {
        let run = lab.render(&name, CORNELL.shot(technique).samples(SAMPLES).with(&options).with_errors())?;
        let found = lab.compare(&run, &reference)?;
        spp = samples(run.spp());
        let off = percent_off(relative(&run.mean()?, &reference.mean()?));
        let efficiency = 1.0 / (found.relmse() * run.seconds());
        rows.push(vec![
            title,
            same(off),
            same(figure(run.rays_per_sample())),
            same(figure(run.seconds())),
            same(figure(found.relmse())),
            same(figure(efficiency)),
        ]);
    }
    sheet.table(
        &[
            text(format!("implicit paths, {spp} spp"), format!("caminos implícitos, {spp} spp")),
            text("bias of the mean", "sesgo de la media"),
            text("rays per sample", "rayos por muestra"),
            text("seconds", "segundos"),
            same("relMSE"),
            text("efficiency, 1/(relMSE s)", "eficiencia, 1/(relMSE s)"),
        ],
        &rows,
    );
    sheet.commands(&lab.take_commands());
    Ok(())
}
