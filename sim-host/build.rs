//! The font of the figures without what drawing them does not need. It is most of what a wheel or an installed program carries
//! that is no code, and no packer finds by itself that nobody reads a part of it.

#[cfg(feature = "figures")]
#[path = "src/figure/lean_font.rs"]
mod lean_font;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    #[cfg(feature = "figures")]
    {
        println!("cargo::rerun-if-changed=src/figure/lean_font.rs");
        let out = std::env::var_os("OUT_DIR").expect("cargo sets it");
        let font = lean_font::lean(dejavu::sans::regular());
        let font = font.expect("a font of the kind that DejaVu is");
        std::fs::write(std::path::Path::new(&out).join("font.ttf"), font)
            .expect("a folder to write to");
    }
}
