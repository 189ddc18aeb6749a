use alabaster::slab::*; use std::sync::atomic::AtomicBool; use std::time::Instant;
fn main(){
 rayon::ThreadPoolBuilder::new().num_threads(1).build_global().unwrap();
 let grid=Grid{radial_step:0.01,radial:50,depth_step:0.001,depth:20,angular:30};
 let vdh=LayerStack::new(1.0,vec![Layer{ior:1.0,sigma_a:10.0,sigma_s:90.0,g:0.75,thickness:0.02}],1.0).unwrap();
 let gio=LayerStack::half_space(1.5,10.0,90.0,0.0).unwrap();
 let skin=LayerStack::half_space(1.4,0.1,100.0,0.9).unwrap();
 for (name,s,n) in [("vdh",vdh,2_000_000u64),("gio",gio,1_000_000),("skin",skin,10_000)] {
  for w in [0.0001,0.05,0.1,0.25,0.5,1.0] {
   let walk=Walk::new(&s,Source::Pencil{cosine:1.0},Roulette{weight:w,..Default::default()});
   let pieces=Pieces::new(&s,grid);
   let stop=AtomicBool::new(false);
   let t=Instant::now();
   let o=estimate(&walk,n,1,||Tally::new(&pieces),|_|{},&stop);
   let e=t.elapsed().as_secs_f64();
   let r=Scattered::new(&pieces,&o.estimates);
   println!("{name} w {w}: {:.3} M/s  R {:.6}±{:.6} T {:.6}±{:.6} spec {:.5} coll {:.4} eff_R {:.3e}",n as f64/e/1e6,r.diffuse_reflectance.value,r.diffuse_reflectance.standard_error,r.transmitted.value,r.transmitted.standard_error,r.specular.value,r.collisions_per_photon.value, 1.0/(r.diffuse_reflectance.standard_error.powi(2)*e));
  }
 }
}
