//! Gives the program for Windows its icon and its manifest. Does nothing for other systems.

fn main() {
    println!("cargo::rerun-if-changed=assets/icon.ico");
    println!("cargo::rerun-if-changed=assets/windows-manifest.xml");
    #[cfg(feature = "cli")]
    if std::env::var_os("CARGO_CFG_TARGET_OS").is_some_and(|system| system == "windows") {
        let mut resource = winresource::WindowsResource::new();
        resource.set_icon("assets/icon.ico").set_manifest_file("assets/windows-manifest.xml");
        if let Err(error) = resource.compile_for("warpbeam") {
            println!("cargo::warning=the program has no icon and no manifest: windres or rc.exe: {error}");
        }
    }
}
