//! `lumbre list`: the tables of techniques and samplers.

use lumbre::error::Result;
use lumbre::integrator::{Bias, INTEGRATORS, Values};
use lumbre::sampler::SAMPLERS;

use super::print;

pub(super) fn run() -> Result<()> {
    for row in INTEGRATORS {
        let bias = match row.bias {
            Bias::Unbiased => String::from("unbiased"),
            Bias::Biased(why) => format!("biased ({why})"),
            Bias::Consistent(why) => format!("consistent ({why})"),
        };
        let blind: String = row.misses.iter().map(|missing| format!("; does not find {}", missing.what())).collect();
        print(&format!("{:<14} {}\n{:14} {}, {bias}{blind}", row.name, row.title, "", row.solves.what()));
        for parameter in row.parameters {
            let values = match parameter.values {
                Values::Choice(words) => words.join("|"),
                Values::Number(low, high, default) => format!("{low}..{high}, default {default}"),
            };
            print(&format!("{:14} :{}={values}\n{:16}{}", "", parameter.name, "", parameter.about));
        }
    }
    print("samplers");
    for row in SAMPLERS {
        print(&format!("{:<14} {}", row.name, row.about));
    }
    Ok(())
}
