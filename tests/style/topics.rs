//! Every file in the folder of a test program is a module of the program: cargo compiles no file that `main.rs` leaves
//! out, and its tests would never run.

use std::path::Path;

use crate::files::rust_files;

#[test]
fn every_topic_is_a_module_of_its_program() {
    for program in ["commands", "fuzz", "physics", "registry", "style", "window"] {
        let folder = Path::new("tests").join(program);
        let main = std::fs::read_to_string(folder.join("main.rs")).unwrap();
        for file in rust_files(&folder) {
            // A topic may be a folder.
            let topic = file.strip_prefix(&folder).unwrap().with_extension("");
            let topic = topic.iter().next().unwrap().to_str().unwrap();
            assert!(topic == "main" || main.contains(&format!("\nmod {topic};\n")), "{}", file.display());
        }
    }
}
