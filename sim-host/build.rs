//! The fonts of the figures without what drawing them does not need. They are most of what a wheel or an installed program carries
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
        for (name, font) in [
            ("regular.ttf", dejavu::sans::regular()),
            ("bold.ttf", dejavu::sans::bold()),
        ] {
            let lean = lean_font::lean(font).expect("a font of the kind that DejaVu is");
            std::fs::write(std::path::Path::new(&out).join(name), lean)
                .expect("a folder to write to");
        }
    }
}
