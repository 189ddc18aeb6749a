use alabaster::slab::*; use alabaster::slab::white::*; use std::sync::atomic::AtomicBool; use std::time::Instant;
fn main(){
 rayon::ThreadPoolBuilder::new().num_threads(1).build_global().unwrap();
 for (eta,g,src) in [(1.0,0.0,Source::Pencil{cosine:1.0}),(1.5,0.0,Source::Pencil{cosine:1.0}),(1.5,0.0,Source::Diffuse),(1.5,0.8,Source::Diffuse)] {
   let n=200_000u64;
   let shares=[0.5,0.1,0.01,0.0001,0.0];
   let walk=white_walk(eta,g,src).unwrap();
   let stop=AtomicBool::new(false);
   let t=Instant::now();
   let o=estimate(&walk,n,1,||WhiteTally::new(eta,&shares),|_|{},&stop);
   let e=t.elapsed().as_secs_f64();
   let entered=o.estimates[shares.len()*RINGS];
   println!("eta {eta} g {g} {src:?}: {:.3} M/s entered {:.6}",n as f64/e/1e6,entered.value);
   for (k,s) in shares.iter().enumerate(){
     let row=&o.estimates[k*RINGS..(k+1)*RINGS];
     let tot:f64=row.iter().map(|e|e.value).sum();
     let noise:f64=row.iter().map(|e|e.standard_error).sum::<f64>()*0.8;
     // merge pairs to 12 per decade in 1e-3..100
     println!("  a {s}: R {:.6} (entered) L1 noise {:.4} (24/dec), n_eff {:.0}",tot/entered.value,noise/tot, 0.64*RINGS as f64/(noise/tot).powi(2));
   }
 }
}
