//! The rooms of the lecture: what they show, how bright their pictures are, and their references.

use std::rc::Rc;

use crate::error::Result;
use crate::lecture::command::Shot;
use crate::lecture::lab::Lab;
use crate::lecture::run::Run;
use crate::lecture::text::{Text, same, text};

/// A scene as the chapters use it.
pub struct Room {
    /// Its file's name.
    pub name: &'static str,
    /// What pictures are multiplied by.
    pub exposure: f64,
    title: (&'static str, &'static str),
    /// What pictures of it show, for those who do not see them.
    alt: (&'static str, &'static str),
    /// Technique of its reference: one that does not find its light hard.
    technique: &'static str,
    budget: Budget,
}

enum Budget {
    Samples(u32),
    Seconds(f64),
}

pub const CORNELL: Room = Room {
    name: "cornell",
    exposure: 2.0,
    title: ("Cornell box", "Caja de Cornell"),
    alt: (
        "the Cornell box: a white room with a red and a green wall, two blocks, and a square lamp in the ceiling",
        "la caja de Cornell: una habitación blanca con una pared roja y otra verde, dos bloques y una lámpara cuadrada en el techo",
    ),
    technique: "path",
    budget: Budget::Samples(8192),
};

pub const SPHERES: Room = Room {
    name: "cornell_spheres",
    exposure: 2.0,
    title: ("Mirror and glass spheres", "Esferas de espejo y de vidrio"),
    alt: (
        "the Cornell box with a mirror sphere and a glass sphere, which throws a bright caustic on the floor",
        "la caja de Cornell con una esfera de espejo y otra de vidrio, que proyecta una cáustica brillante en el suelo",
    ),
    technique: "bdpt",
    budget: Budget::Seconds(40.0),
};

pub const SMALL_LIGHT: Room = Room {
    name: "caustic_small_light",
    exposure: 1.0,
    title: ("Caustics of a small bright light", "Cáusticas de una luz pequeña e intensa"),
    alt: (
        "a glass ball and a wine glass on a floor, their shadows filled with bright caustics",
        "una bola de vidrio y una copa sobre el suelo, con cáusticas brillantes dentro de sus sombras",
    ),
    technique: "vcm",
    budget: Budget::Seconds(40.0),
};

pub const RING: Room = Room {
    name: "ring_caustic",
    exposure: 1.0,
    title: ("Caustic of a metal ring", "Cáustica de un anillo metálico"),
    alt: (
        "a golden ring on a table in low sunlight, with a bright cusped curve of light inside it",
        "un anillo dorado sobre una mesa a pleno sol bajo, con una curva de luz en punta en su interior",
    ),
    technique: "vcm",
    budget: Budget::Seconds(40.0),
};

pub const REFLECTED: Room = Room {
    name: "reflected_caustic",
    exposure: 1.0,
    title: ("A caustic seen in a mirror", "Una cáustica vista en un espejo"),
    alt: (
        "a glass ball before a mirror; the mirror shows a card with a bright caustic on its far side",
        "una bola de vidrio delante de un espejo; en él se ve una tarjeta con una cáustica brillante en su cara posterior",
    ),
    technique: "vcm",
    budget: Budget::Seconds(40.0),
};

pub const DOOR: Room = Room {
    name: "door_ajar",
    exposure: 4.0,
    title: ("A door ajar", "Una puerta entreabierta"),
    alt: (
        "a dim room with a teapot, a jug and a carafe on a table, lit only through a door that is slightly open",
        "una habitación en penumbra con una tetera, una jarra y una garrafa sobre una mesa, iluminada solo por una puerta entreabierta",
    ),
    technique: "bdpt",
    budget: Budget::Seconds(50.0),
};

pub const LAMPS: Room = Room {
    name: "bidirectional_room",
    exposure: 1.0,
    title: ("Lamps that shine at ceiling and table", "Lámparas que alumbran el techo y la mesa"),
    alt: (
        "a room lit by a floor lamp that shines at the ceiling and a spot that shines at a glass egg on a table",
        "una habitación iluminada por una lámpara de pie que alumbra el techo y un foco que alumbra un huevo de vidrio sobre una mesa",
    ),
    technique: "bdpt",
    budget: Budget::Seconds(40.0),
};

impl Room {
    /// Its title.
    pub fn title(&self) -> Text {
        text(self.title.0, self.title.1)
    }

    /// The text of a picture of it, made in some way.
    pub fn alt(&self, how: &Text) -> Text {
        text(format!("{}; {}", self.alt.0, how.en), format!("{}; {}", self.alt.1, how.es))
    }

    /// The text of a picture of it by a technique.
    pub fn alt_by(&self, technique: &str) -> Text {
        self.alt(&same(technique))
    }

    /// A picture of it by a technique.
    pub fn shot(&self, technique: impl Into<String>) -> Shot {
        Shot::new(self.name, technique)
    }

    /// The picture that stands for the truth.
    pub fn reference(&self, lab: &mut Lab) -> Result<Rc<Run>> {
        let shot = self.shot(self.technique);
        let shot = match self.budget {
            Budget::Samples(spp) => shot.samples(spp),
            Budget::Seconds(seconds) => shot.seconds(seconds),
        };
        lab.render(&format!("{}-reference", self.name), shot.with_own_seed())
    }
}
