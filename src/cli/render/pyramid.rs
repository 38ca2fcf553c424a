//! The strategies as one picture: a row for each path length, a column for each number of vertices from the light, as Veach's thesis
//! shows them (figures 10.2 and 10.3): on the left each strategy by itself, on the right its share of the image.

use lumbre::image::Image;
use lumbre::render::film::Film;
use lumbre::techniques::Strategy;

/// Pixels between pictures, and around all.
const GAP: usize = 6;
/// Pixels that a dot of a label takes.
const DOT: usize = 2;
/// Rows and columns of dots of a character.
const CHARACTER: [usize; 2] = [5, 3];
/// Height of a label with its distance from the picture.
const LABEL: usize = CHARACTER[0] * DOT + 4;
/// Brightness of the ground and of labels, linear.
const GROUND: [f32; 3] = [0.03; 3];
const INK: [f32; 3] = [0.8; 3];

/// Characters of labels, one row of three dots after the other.
const FONT: [(char, &str); 13] = [
    ('0', "#### ## ## ####"),
    ('1', " # ##  #  # ###"),
    ('2', "###  #####  ###"),
    ('3', "###  ####  ####"),
    ('4', "# ## ####  #  #"),
    ('5', "####  ###  ####"),
    ('6', "####  #### ####"),
    ('7', "###  #  #  #  #"),
    ('8', "#### ##### ####"),
    ('9', "#### ####  ####"),
    ('s', " ###   #   ### "),
    ('t', " # ### #  #  ##"),
    ('=', "   ###   ###   "),
];

/// A picture that others are put on.
struct Canvas(Image);

impl Canvas {
    fn put(&mut self, left: usize, top: usize, image: &Image) {
        let (width, across) = (image.width as usize, self.0.width as usize);
        for (y, row) in image.pixels.chunks_exact(width).enumerate() {
            let start = (top + y) * across + left;
            self.0.pixels[start..start + width].copy_from_slice(row);
        }
    }

    /// Writes as much as fits into `width` pixels.
    fn write(&mut self, left: usize, top: usize, width: usize, text: &str) {
        let step = (CHARACTER[1] + 1) * DOT;
        for (place, character) in text.chars().enumerate().take_while(|(place, _)| (place + 1) * step <= width + DOT) {
            let Some((_, dots)) = FONT.iter().find(|(known, _)| *known == character) else { continue };
            for (dot, _) in dots.chars().enumerate().filter(|(_, dot)| *dot == '#') {
                for pixel in 0..DOT * DOT {
                    let x = left + place * step + dot % CHARACTER[1] * DOT + pixel % DOT;
                    let y = top + dot / CHARACTER[1] * DOT + pixel / DOT;
                    self.0.pixels[y * self.0.width as usize + x] = INK;
                }
            }
        }
    }
}

/// Both pyramids; nothing where the film has no strategies.
pub(super) fn pyramid(film: &Film) -> Option<Image> {
    let rows = film.strategies.iter().map(|layers| layers.strategy.segments()).max()? as usize;
    let columns = film.strategies.iter().map(|layers| layers.strategy.s).max()? as usize + 1;
    let (cell_width, cell_height) = (film.width as usize + GAP, film.height as usize + LABEL + GAP);
    let side = columns * cell_width;
    let (width, height) = (2 * side + 3 * GAP, rows * cell_height + GAP);
    let ground = Image { width: width as u32, height: height as u32, pixels: vec![GROUND; width * height] };
    let mut canvas = Canvas(ground);
    for layers in &film.strategies {
        let Strategy { s, t } = layers.strategy;
        let row = layers.strategy.segments() as usize;
        // Rows are centred: strategies of neighbouring lengths stand in the gaps of each other.
        let indent = (rows - row) * cell_width / 2;
        let (left, top) = (GAP + indent + s as usize * cell_width, GAP + (row - 1) * cell_height);
        for (shift, sums) in [(0, &layers.unweighted), (side + GAP, &layers.weighted)] {
            canvas.write(left + shift, top, film.width as usize, &format!("s={s} t={t}"));
            canvas.put(left + shift, top + LABEL, &film.image_of(sums));
        }
    }
    Some(canvas.0)
}
