//! The short form of `lumbre verify`: every row of its table, on every backend.

use crate::common::{backends, check_gpu, open_gpu, with_gpu};
use lumbre::verify::{CASES, Case, Effort, Verdict, find, measure_all};

/// All figures are within their bounds, or beyond them by the driver's own doing.
#[test]
fn every_row_passes() {
    let mut broken = Vec::new();
    let backends = with_gpu(backends);
    let cases: Vec<&Case> = CASES.iter().collect();
    measure_all(open_gpu, check_gpu, &cases, &backends, Effort::Short, None, |outcome| {
        println!("{} on {}: {:?}, {:.1} s", outcome.case, outcome.backend, outcome.verdict(), outcome.seconds);
        for figure in outcome.figures.iter().filter(|figure| figure.verdict >= Verdict::Driver) {
            println!("    {figure:?}");
        }
        if outcome.verdict() == Verdict::Fail {
            broken.push(format!("{} on {}: lumbre verify --short --case {0}", outcome.case, outcome.backend));
        }
        Ok(())
    })
    .unwrap();
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

/// Names are unique and fit for file names; an unknown one lists those that there are.
#[test]
fn rows_have_names() {
    for (index, case) in CASES.iter().enumerate() {
        assert!(case.name.chars().all(|c| c.is_ascii_lowercase() || c == '-'), "{}", case.name);
        assert!(CASES[..index].iter().all(|other| other.name != case.name), "{}", case.name);
        assert!(![case.tests, case.bound, case.source].contains(&""), "{}", case.name);
    }
    let message = find("teapot").err().unwrap().to_string();
    assert!(message.contains("no case 'teapot'") && message.contains("furnace") && message.contains("watertight"));
}

/// A bound that is broken is a figure, and one that is no number is within no bound.
#[test]
fn figures_can_fail() {
    use lumbre::verify::Figure;
    assert_eq!(Figure::at_most("path", "off", 0.5, 1.0).verdict, Verdict::Pass);
    assert_eq!(Figure::at_most("path", "off", 1.5, 1.0).verdict, Verdict::Fail);
    assert_eq!(Figure::at_most("path", "off", f64::NAN, 1.0).verdict, Verdict::Fail);
    assert_eq!(Figure::relative("path", "mean", 2.0, 1.0, 0.1).verdict, Verdict::Fail);
    let driver = Figure::at_most("trace", "rays lost", 3.0, 0.0).by_driver("llvmpipe");
    assert!(driver.verdict == Verdict::Driver && driver.worst.starts_with("llvmpipe"));
}

/// A broken bound fails the command, which was itself right.
#[test]
fn a_broken_bound_is_a_failure_of_the_work() {
    let error = lumbre::error::Error::Verification(String::from("furnace on bvh"));
    assert!(error.exit_status() == 1 && error.to_string() == "beyond their bounds: furnace on bvh");
}
