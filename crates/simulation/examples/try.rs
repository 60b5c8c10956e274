use anergy_simulation::{build, model::Model, simulation::Simulation, steady};
fn main() {
    let path = std::env::args().nth(1).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    let model = match Model::from_toml(&text, std::path::Path::new(&path).parent().unwrap()) {
        Ok(m) => m,
        Err(e) => {
            println!("{}", e.render(&text));
            return;
        }
    };
    match steady::solve(&model) {
        Ok(s) => {
            for n in &s.nodes {
                println!("{:24} {:10.2} Pa {:8.4} degC", n.id, n.p_pa, n.t_k - 273.15);
            }
            for e in &s.edges {
                println!("{:24} {:10.5} l/min {:10.3} Pa", e.id, e.m_flow_kg_s * 60.0, e.dp_pa);
            }
            println!("{} {}", s.iterations, s.residual_pa);
        }
        Err(e) => println!("{e}"),
    }
    let plan = match build::build(&model) {
        Ok(p) => p,
        Err(e) => {
            println!("{}", e.render(&text));
            return;
        }
    };
    let mut sim = Simulation::new(plan).unwrap();
    let t = std::time::Instant::now();
    let mut rec = anergy_core::recorder::MemoryRecorder::default();
    struct R<'a>(&'a mut anergy_core::recorder::MemoryRecorder);
    use anergy_core::recorder::*;
    impl Recorder for R<'_> {
        fn start(
            &mut self,
            h: &RunHeader,
            c: &[Channel],
        ) -> Result<(), anergy_core::error::RecordError> {
            self.0.start(h, c)
        }
        fn row(
            &mut self,
            t: anergy_core::clock::Time,
            v: &[f64],
        ) -> Result<(), anergy_core::error::RecordError> {
            self.0.row(t, v)
        }
        fn event(&mut self, e: &Event) -> Result<(), anergy_core::error::RecordError> {
            println!("{} {}", e.time, e.message);
            self.0.event(e)
        }
        fn finish(
            self: Box<Self>,
            _s: &serde_json::Value,
        ) -> Result<(), anergy_core::error::RecordError> {
            Ok(())
        }
    }
    let r = anergy_simulation::run::run(
        &mut sim,
        Default::default(),
        Box::new(R(&mut rec)),
        &mut |_, _| true,
    )
    .unwrap();
    println!("{:?}", t.elapsed());
    println!("{:#}", r.summary);
    for n in ["sf1.station.m_flow_kg_s", "sf2.station.m_flow_kg_s"] {
        if let Some(c) = rec.recording.column(n) {
            println!("{n} {:.4} {:.4}", c[200] * 60.0, c[c.len() - 1] * 60.0);
        }
    }
}
