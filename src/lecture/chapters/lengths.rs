//! The contribution of paths of each length.

use super::prelude::*;
use super::scenes::CORNELL;
use crate::lecture::run::average;
use crate::lecture::sheet::figure_of_percent;
use crate::lecture::view;

pub const CHAPTER: Chapter = Chapter {
    name: "lengths",
    titles: ("Path lengths 1 to 7", "Longitudes de camino de 1 a 7"),
    needs: &["path"],
    write,
};

const LONGEST: usize = 7;

fn write(lab: &mut Lab, sheet: &mut Sheet) -> Result<()> {
    sheet.question(text(
        "What does each further bounce add, and when does it stop to matter?",
        "¿Qué añade cada rebote, y a partir de cuándo deja de importar?",
    ));
    sheet.equation(
        "L = ∑ _ { k = 1 } ^ ∞ T ^ { k − 1 } L _ e",
        text(
            "A path of k segments runs over k − 1 scattering surfaces. One segment is a lamp seen directly, two are direct light, three \
             and more are indirect.",
            "Un camino de k segmentos pasa por k − 1 superficies que dispersan. Un segmento es una lámpara vista directamente, dos son \
             luz directa, y tres o más, indirecta.",
        ),
    );
    let options = format!("--lengths={LONGEST} --max-depth {LONGEST}");
    let run = lab.render("lengths", CORNELL.shot("path").samples(1024).with(&options).with_errors())?;
    let layers = (1..=LONGEST).map(|k| run.layer(&format!("length{k:02}"))).collect::<Result<Vec<Image>>>()?;
    let sum = view::sum(&layers).unwrap_or_else(|| run.image.clone());
    let means: Vec<f64> = layers.iter().map(average).collect();
    let total = average(&run.image);

    let mut cells: Vec<Cell> = layers
        .iter()
        .zip(&means)
        .zip(1..)
        .map(|((layer, mean), k)| {
            let title = length_title(k);
            let share = of(figure_of_percent(mean / total), "");
            image(&format!("length-{k}"), layer, CORNELL.exposure, title.clone(), CORNELL.alt(&title), vec![share])
        })
        .collect();
    let title = text("Their sum", "Su suma");
    cells.push(image(
        "length-sum",
        &sum,
        CORNELL.exposure,
        title.clone(),
        CORNELL.alt(&title),
        vec![of(figure_of_percent(1.0), "")],
    ));
    sheet.gallery(4, cells, exposure_note(CORNELL.exposure))?;

    sheet.heading(text(
        "The same, each made as bright as direct light",
        "Lo mismo, con cada longitud tan clara como la luz directa",
    ));
    let brighter = layers.iter().zip(&means).zip(1..).skip(1).map(|((layer, mean), k)| {
        let exposure = CORNELL.exposure * (means[1] / mean.max(1e-12)).min(1e6);
        let title = length_title(k);
        let note = text(format!("exposure ×{}", figure(exposure)), format!("exposición ×{}", figure(exposure)));
        image(&format!("length-{k}-brighter"), layer, exposure, title.clone(), CORNELL.alt(&title), vec![note])
    });
    sheet.gallery(6, brighter.collect(), same(""))?;

    let rows: Vec<Vec<Text>> = means
        .iter()
        .enumerate()
        .map(|(index, mean)| {
            let before = index.checked_sub(1).map_or(f64::NAN, |before| mean / means[before]);
            vec![
                same((index + 1).to_string()),
                same(figure(*mean)),
                same(figure_of_percent(mean / total)),
                same(figure(if index < 2 { f64::NAN } else { before })),
            ]
        })
        .collect();
    sheet.table(
        &[
            text("segments", "segmentos"),
            text("mean radiance", "radiancia media"),
            text("share", "fracción"),
            text("over the one before", "respecto a la anterior"),
        ],
        &rows,
    );
    let reference = CORNELL.reference(lab)?;
    let missing = percent_off(relative(&run.mean()?, &reference.mean()?));
    let off = figure(view::largest_difference(&sum, &run.image));
    sheet.see(text(
        format!(
            "Each bounce adds a like share of the one before it, for that much is what the walls reflect; and each is flatter, redder and greener \
             than the one before. The sum of the layers is the image: the largest difference of any channel is {off}. Against a reference \
             without a limit, ending at {LONGEST} segments gives a mean that is off by {missing}."
        ),
        format!(
            "Cada rebote aporta una fracción parecida del anterior, pues eso es lo que reflejan las paredes; y cada uno es más uniforme y más \
             teñido que el anterior. La suma de las capas es la imagen: la mayor diferencia en un canal es {off}. Frente a una referencia sin \
             límite, cortar a los {LONGEST} segmentos deja una media desviada en {missing}."
        ),
    ));
    sheet.commands(&lab.take_commands());
    Ok(())
}

fn length_title(segments: usize) -> Text {
    match segments {
        1 => text("1 segment: emission", "1 segmento: emisión"),
        2 => text("2 segments: direct light", "2 segmentos: luz directa"),
        k => text(format!("{k} segments"), format!("{k} segmentos")),
    }
}
