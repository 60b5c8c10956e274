#![allow(warnings)]
use anergy_benches::*; use anergy_core::clock::*; use anergy_network::{state::NetworkState,hydraulics::HydraulicSolver};
use anergy_simulation::{build::build,model::Model,simulation::Simulation,steady};
use std::path::Path; use std::time::Instant;
const SPEEDS: [f64; 7] = [1.0, 0.997, 1.002, 0.995, 0.999, 0.993, 0.998];
fn main(){
 let a:Vec<String>=std::env::args().collect();
 let demo=std::fs::read_to_string("examples/three-houses/model.toml").unwrap();
 let text=match a[2].as_str(){"demo"=>demo,"edges"=>two_pipe_network_with_edges(1000,1),n=>two_pipe_network(n.parse().unwrap(),1)};
 let t=Instant::now(); let model=Model::from_toml(&text,Path::new(".")).unwrap(); eprintln!("read {:?}",t.elapsed());
 let n:usize=a[3].parse().unwrap();
 let t=Instant::now(); let plan=build(&model).unwrap(); eprintln!("build {:?} edges {} nodes {}",t.elapsed(),plan.network().edges.len(),plan.network().nodes.len());
 let net=plan.network();
 let pumpname=if a[2]=="demo"{"sf2.feed_in_pump"}else{"plant.feed_in_pump"};
 let speed=if a[2]=="demo"{0.85}else{0.99};
 match a[1].as_str(){
 "warm"|"cold"=>{
  let mut s=NetworkState::new(net,323.15); s.given_p_pa.fill(1.5e5); s.p_pa.fill(1.5e5);
  let f=|x:&str|plan.edge_names().iter().position(|e|e==x);
  if let Some(o)=f("sf1.feed_in_pump"){s.position[o]=0.95;}
  let pump=f(pumpname).unwrap(); s.position[pump]=speed; let rest=s.clone();
  let valves:Vec<usize>=(0..net.edges.len()).filter(|&i|plan.edge_names()[i].ends_with("extraction_valve")).step_by(10).collect();
  let t=Instant::now(); let mut solver=HydraulicSolver::new(net).unwrap(); eprintln!("analyze {:?}",t.elapsed());
  let r=solver.solve(net,&mut s).unwrap(); eprintln!("cold iterations {}",r.iterations);
  let mut it=0; let t=Instant::now();
  for k in 0..n { if a[1]=="cold"{s.m_flow_kg_s.copy_from_slice(&rest.m_flow_kg_s);s.p_pa.copy_from_slice(&rest.p_pa);s.position.copy_from_slice(&rest.position);}
   else {let q=SPEEDS[k%7]; s.position[pump]=speed*q; for &v in &valves{s.position[v]=rest.position[v]*q.min(1.0);}}
   s.invalidate_hydraulics(); it+=solver.solve(net,&mut s).unwrap().iterations;}
  eprintln!("{:?} per solve, {} iterations per solve",t.elapsed()/n as u32,it as f64/n as f64);
 }
 _=>{
  let mut sim=Simulation::new(plan.clone()).unwrap(); let t=Instant::now(); steady::settle(&mut sim).unwrap(); eprintln!("settle {:?}",t.elapsed());
  let sig=sim.signal(&format!("{pumpname}.speed")).unwrap(); let step_s:i64=a.get(4).map_or(1,|x|x.parse().unwrap());
  let dt=Time(step_s*NS_PER_S);
  let t=Instant::now();
  for k in 0..n { if a[1]=="change"{sim.set(sig,speed*SPEEDS[k%7]).unwrap();} let e=sim.time()+dt; sim.advance_to(e,dt).unwrap();}
  eprintln!("{:?} per step",t.elapsed()/n as u32);
 }}
}
