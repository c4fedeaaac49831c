//! Reads "x y" lines from standard input and prints the triangles of their points, in Rust.
use std::ffi::{c_char, c_int, c_uint, CStr};
use std::io::{read_to_string, stdin};

#[repr(C)]
pub struct LmMesh {
    _private: [u8; 0],
}

#[link(name = "liftmesh")]
extern "C" {
    fn lm_delaunay(points: *const f64, n: usize, threads: c_uint, mesh: *mut *mut LmMesh) -> c_int;
    fn lm_triangle_count(mesh: *const LmMesh) -> usize;
    fn lm_triangles(mesh: *const LmMesh) -> *const i32;
    fn lm_free(mesh: *mut LmMesh);
    fn lm_message(status: c_int) -> *const c_char;
}

fn triangulate(points: &[f64]) -> Result<Vec<i32>, (c_int, String)> {
    let mut mesh = std::ptr::null_mut();
    unsafe {
        let status = lm_delaunay(points.as_ptr(), points.len() / 2, 0, &mut mesh);
        let found = if status == 0 {
            let corners = 3 * lm_triangle_count(mesh);
            Ok(std::slice::from_raw_parts(lm_triangles(mesh), corners).to_vec())
        } else {
            Err((status, CStr::from_ptr(lm_message(status)).to_string_lossy().into_owned()))
        };
        lm_free(mesh);
        found
    }
}

fn main() {
    let text = read_to_string(stdin()).expect("standard input");
    let points: Vec<f64> = text.split_whitespace().map(|word| word.parse().expect("a number")).collect();
    match triangulate(&points) {
        Ok(corners) => corners.chunks(3).for_each(|t| println!("{} {} {}", t[0], t[1], t[2])),
        Err((status, message)) => {
            eprintln!("{message}");
            std::process::exit(status);
        }
    }
}
