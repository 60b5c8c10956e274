use super::*;
use crate::bench;
use crate::catalogue::{candidates, effect_target, tolerances};
use crate::unknown::Target;

fn loss(pipe: &str, factor: f64) -> (Unknown, f64) {
    (Unknown::plain(effect_target("P2", pipe, "factor"), 1.0, 1.0), factor)
}

/// What is tried on the bench: wrong insulation of both pipes.
fn insulations(experiment: &Experiment) -> Vec<Candidate> {
    let mut all = candidates(experiment);
    all.retain(|candidate| candidate.id == "P2");
    assert_eq!(all.iter().map(|c| c.component.as_str()).collect::<Vec<_>>(), ["near", "far"]);
    all
}

fn spread(experiment: &Experiment) -> Spread {
    Spread::new(experiment, experiment.simulated(&[], &[], 1).unwrap(), &[], &[])
}

fn search<'a>(experiment: &'a Experiment, spread: &'a Spread, all: &'a [Candidate]) -> Search<'a> {
    let n = experiment.samples.len();
    let likelihood = Likelihood::new(vec![0.05; n], (0..n).collect());
    let base = tolerances(experiment);
    Search::new(experiment, spread, all, base, likelihood, (0..n).collect())
}

/// A search that has taken all candidates, one after the other.
fn with_all<'a>(
    experiment: &'a Experiment,
    spread: &'a Spread,
    all: &'a [Candidate],
) -> (Search<'a>, Settled) {
    let (mut search, mut settled) = (search(experiment, spread, all), Settled::nothing());
    let unknowns: &[Unknown] = &search.base;
    let at: Vec<f64> = unknowns.iter().map(|u| u.start).collect();
    settled.null_readings = experiment.readings(unknowns, &at).unwrap();
    for k in 0..all.len() {
        let start = Start { candidates: vec![k], at: vec![0.0], earlier: None };
        let mut tried = search.common().fits(&[start], Care::Quick);
        let null = fit(experiment, &search.base, &search.likelihood, &search.slopes, Care::Quick);
        let findings = search.ranked(&null.unwrap(), &mut tried);
        search.take(&tried[0], &findings, &mut settled).unwrap();
    }
    (search, settled)
}

#[test]
fn a_step_back_takes_out_what_is_superfluous_and_nothing_else() {
    let only_far = bench::experiment(&[loss("far", 3.0)]);
    let all = insulations(&only_far);
    let might = spread(&only_far);
    let (mut search, mut settled) = with_all(&only_far, &might, &all);
    search.step_back(&mut settled).unwrap();
    assert_eq!(search.taken, [1]);
    assert_eq!((settled.effects.len(), settled.effects[0].component.as_str()), (1, "far"));
    // Its insulation is a tolerance again.
    let near = search.base.iter().find(|u| u.target == all[0].unknown.target).unwrap();
    assert!(near.sd < 0.1, "{near:?}");

    let of_both = bench::experiment(&[loss("near", 3.0), loss("far", 3.0)]);
    let all = insulations(&of_both);
    let might = spread(&of_both);
    let (mut search, mut settled) = with_all(&of_both, &might, &all);
    search.step_back(&mut settled).unwrap();
    assert_eq!((search.taken.len(), settled.effects.len()), (2, 2));
    // The first one was fitted without the second: of its value only a fit of both knows.
    let off = |f: &Finding| (f.estimate.value - 3.0).abs();
    assert!(off(&settled.effects[0]) > 0.3, "{:?}", settled.effects[0]);
    search.joint(&mut settled).unwrap();
    for effect in &settled.effects {
        let holds = (effect.estimate.lo..=effect.estimate.hi).contains(&3.0);
        assert!(holds && off(effect) < 0.1, "{effect:?}");
    }
}

#[test]
fn a_step_back_asks_for_the_others_again() {
    // Of the near pipe nothing is wrong: its insulation goes, and the warmer ground that had stood beside it.
    let experiment = bench::experiment(&[loss("far", 3.0)]);
    let mut all = candidates(&experiment);
    let of_near = |c: &Candidate| ["P2", "P3"].contains(&c.id) && c.component == "near";
    all.retain(|c| of_near(c) || (c.id == "P2" && c.component == "far"));
    assert_eq!(all.iter().map(|c| c.id).collect::<Vec<_>>(), ["P2", "P3", "P2"]);
    let might = spread(&experiment);
    let (mut search, mut settled) = with_all(&experiment, &might, &all);
    search.step_back(&mut settled).unwrap();
    assert_eq!(search.taken, [2]);
    assert_eq!((settled.effects.len(), settled.effects[0].component.as_str()), (1, "far"));
}

#[test]
fn what_leaves_far_more_than_another_is_refuted() {
    let experiment = bench::experiment(&[loss("far", 3.0)]);
    let all = insulations(&experiment);
    let might = spread(&experiment);
    let search = search(&experiment, &might, &all);
    let start = |k| Start { candidates: vec![k], at: vec![0.0], earlier: None };
    let mut tried = search.common().fits(&[start(0), start(1)], Care::Quick);
    let null = fit(&experiment, &search.base, &search.likelihood, &search.slopes, Care::Quick);
    let findings = search.ranked(&null.unwrap(), &mut tried);
    let of = |f: &Finding| (f.component.clone(), f.probability > 0.8);
    // What the near pipe loses more, the sensor in the middle would see.
    assert_eq!(
        findings.iter().map(of).collect::<Vec<_>>(),
        [("far".to_owned(), true), ("near".to_owned(), false)]
    );
    assert_eq!(findings[1].probability, 0.0, "{findings:?}");
    assert!((findings[0].estimate.value - 3.0).abs() < 0.2, "{:?}", findings[0].estimate);
}

#[test]
fn a_pair_is_taken_where_it_explains_more_than_one() {
    // The near pipe loses less, the far one more: the house hardly sees it.
    let experiment = bench::experiment(&[loss("near", 0.4), loss("far", 2.0)]);
    let settled = |most: f64| {
        let mut all = insulations(&experiment);
        all[0].most = most;
        let might = spread(&experiment);
        let mut search = search(&experiment, &might, &all);
        let null = fit(&experiment, &search.base, &search.likelihood, &search.slopes, Care::Quick);
        let null = search.leave_out(null.unwrap());
        let z = search.z(&null.readings);
        let round = search.round(null, z, &mut Stopwatch::new()).unwrap().unwrap();
        let first = search.first(round).unwrap();
        let mut settled = Settled { verdict: Verdict::Unexplained, ..Settled::nothing() };
        search.pair(&first, &mut settled).unwrap();
        assert_eq!(search.taken.len(), settled.effects.len());
        settled
    };
    let both = settled(f64::INFINITY);
    assert_eq!((both.verdict, both.effects.len()), (Verdict::Named, 2), "{}", both.because);
    let value =
        |pipe: &str| both.effects.iter().find(|f| f.component == pipe).unwrap().estimate.value;
    assert!((value("near") - 0.4).abs() < 0.15 && (value("far") - 2.0).abs() < 0.3);
    // Readings rule one of them out.
    assert_eq!(settled(-5.0).verdict, Verdict::Unexplained);
}

#[test]
fn a_jump_is_found_where_it_was_and_is_no_drift() {
    // Of a sensor that is compared, and of one that drives the model.
    for (sensor, column) in [(3, "T_house"), (0, "T_in")] {
        let jump = (Unknown::plain(Target::Step(sensor), 0.0, 2.5), -1.6);
        let moment = (Unknown::plain(Target::StepShare(sensor), 0.5, 0.3), 0.42);
        let experiment = bench::experiment(&[jump, moment]);
        let mut all = candidates(&experiment);
        all.retain(|c| c.id == "S3" && c.component == column);
        let might = spread(&experiment);
        let mut search = search(&experiment, &might, &all);
        let settled = search.run(&mut Stopwatch::new()).unwrap();
        let [found] = &settled.effects[..] else { panic!("{column}: {:?}", settled.effects) };
        assert_eq!((found.id, found.parameter), ("S3", "step_k"));
        assert!((found.estimate.value + 1.6).abs() < 0.05, "{:?}", found.estimate);
        let share = found.beside[0].1;
        assert!((share - 0.42).abs() < 0.02, "{column}: {share}");
        // The drift was tried too; of one effect at one place the best counts.
        assert_eq!(settled.tried.len(), 1);
    }
}

#[test]
fn what_leaves_much_at_a_sensor_is_another_cause() {
    // Beyond what the insulation of the far pipe could be, the sensor behind it swings: nothing that is tried.
    let mut experiment = bench::experiment(&[loss("far", 3.0)]);
    let all = insulations(&experiment);
    let of = |experiment: &Experiment| {
        let might = spread(experiment);
        let mut search = search(experiment, &might, &all);
        search.run(&mut Stopwatch::new()).unwrap()
    };
    assert_eq!(of(&experiment).verdict, Verdict::Named);
    for sample in experiment.samples.iter_mut().filter(|s| s.sensor == 3) {
        let on = ((sample.time_s / 300.0) as usize).is_multiple_of(2);
        sample.value += if on { 1.5 } else { -1.5 };
    }
    let settled = of(&experiment);
    assert_eq!(settled.verdict, Verdict::Unexplained, "{}", settled.because);
    assert!(settled.effects.is_empty() && settled.chosen.is_none());
}

#[test]
fn afresh_tolerances_stand_where_they_were_before_any_fit() {
    let only_far = bench::experiment(&[loss("far", 3.0)]);
    let all = insulations(&only_far);
    let might = spread(&only_far);
    let mut search = search(&only_far, &might, &all);
    // All the way to their bounds.
    search.base.iter_mut().for_each(|u| u.start = u.mean + crate::fit::BOUND_SD * u.sd);
    let found = search.afresh(&[0, 1]);
    let best =
        found.iter().max_by(|a, b| a.fit.log_evidence.total_cmp(&b.fit.log_evidence)).unwrap();
    assert_eq!(best.candidates, [1]);
    let place = best.places[0];
    let factor = best.unknowns[place].value(best.fit.at[place]);
    assert!((factor - 3.0).abs() < 0.2, "{factor}");
    assert!(best.unknowns.iter().enumerate().all(|(i, _)| !best.fit.at_bound(&best.unknowns, i)));
}

#[test]
fn tolerances_with_which_the_model_alone_does_not_run_are_no_start() {
    let only_far = bench::experiment(&[loss("far", 3.0)]);
    let all = insulations(&only_far);
    let might = spread(&only_far);
    let search = search(&only_far, &might, &all);
    let null =
        fit(&only_far, &search.base, &search.likelihood, &Slopes::new(), Care::Quick).unwrap();
    let start = Start { candidates: vec![1], at: vec![1.0], earlier: None };
    let mut tried = search.common().fits(&[start], Care::Quick);
    let is_first = |u: &Unknown| matches!(u.target, Target::Initial(0));
    let first = tried[0].unknowns.iter().position(is_first).unwrap();
    // Water of 47 degC is valid until 99 degC.
    tried[0].fit.at[first] = 60.0;
    let evidence = null.log_evidence;
    assert_eq!(search.null_beside(null, &tried).log_evidence, evidence);
}
