//! `compare` on tables that cannot be taken as they stand, and on those that only look so.

use serde_json::Value;
use std::path::PathBuf;
use std::process::{Command, Output};
use tempfile::TempDir;

/// Tables in a folder of their own.
struct Desk(TempDir);

impl Desk {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::create_dir_all(self.path(name).parent().unwrap()).unwrap();
        std::fs::write(self.path(name), text).unwrap();
    }

    fn compare(&self, args: &[&str]) -> Output {
        let mut program = Command::new(env!("CARGO_BIN_EXE_surfometry"));
        program.arg("compare").args(args).current_dir(self.0.path()).output().expect("the program runs")
    }

    /// The error of a comparison that must fail, and must leave nothing behind.
    #[track_caller]
    fn refused(&self, args: &[&str]) -> String {
        let _ = std::fs::remove_file(self.path("all.json"));
        let output = self.compare(&[args, &["-o", "all.json"]].concat());
        assert_eq!(output.status.code(), Some(2), "{}", text(&output.stdout));
        assert!(!self.path("all.json").exists() && output.stdout.is_empty());
        text(&output.stderr).to_owned()
    }

    /// The document of a comparison that must work.
    #[track_caller]
    fn document(&self, args: &[&str]) -> Value {
        let output = self.compare(&[args, &["-o", "all.json"]].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        serde_json::from_slice(&std::fs::read(self.path("all.json")).unwrap()).unwrap()
    }

    #[track_caller]
    fn bias(&self, args: &[&str]) -> f64 {
        let document = self.document(args);
        document["measures"][0]["agreement"]["bland_altman"]["bias"]["value"].as_f64().unwrap()
    }
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).expect("UTF-8")
}

/// Objects a, b, c of 11, 22, 33 by the method.
const METHOD: &str = "input,volume_mm3\na,11\nb,22\nc,33\n";

/// A number that may be a thousand times as large is refused wherever another cell of the table, of the folder or
/// of the column tells that it may.
#[test]
fn decimal_signs_are_not_mixed() {
    let desk = Desk::new();
    desk.write("method.csv", METHOD);
    let mixed = [
        ("input;volume_mm3\na;1.234\nb;12,5\nc;33\n", "line 3 has `12,5` in column `volume_mm3`"),
        ("input;volume_mm3\na;1.234\nb;12,5\nc;33\n", "line 2 has `1.234` in column `volume_mm3`"),
        (
            "input;volume_mm3;thickness\na;1.234;0,25\nb;2.345;1,5\nc;3.456;2\n",
            "line 2 has `0,25` in column `thickness`",
        ),
        ("input\tvolume_mm3\tthickness\na\t1.234\t0,25\nb\t2.345\t1,5\nc\t3.456\t2\n", "are mixed"),
        ("input,volume_mm3,thickness\na,1.234,\"0,25\"\nb,2.345,\"1,5\"\nc,3.456,2\n", "are mixed"),
        ("input;volume_mm3;thickness\na;1,234;0.25\nb;2,345;1.5\nc;3,456;2\n", "are mixed"),
        ("input;volume_mm3\na;1.234\nb;1,234\nc;33\n", "are mixed"),
        (
            "input;volume_mm3\na;1.234,5\nb;12,5\nc;33\n",
            "`1.234,5` in column `volume_mm3`, with a sign between thousands",
        ),
        ("input,volume_mm3\na,\"1,234.5\"\nb,12.5\nc,33\n", "with a sign between thousands"),
        ("input;volume_mm3\na;1.234.567\nb;12\nc;33\n", "with a sign between thousands"),
        ("input,volume_mm3\na,\"1,234\"\nb,12\nc,33\n", "`1,234` in column `volume_mm3`, which is no number"),
        ("input\tvolume_mm3\na\t12,5\nb\t12\nc\t33\n", "`12,5` in column `volume_mm3`, which is no number"),
        ("input;volume_mm3\na;1 234,5\nb;12\nc;33\n", "which is no number; write it as 1234.5"),
        // Of an object that is in no other table too.
        ("input;volume_mm3\na;1.234\nb;2.345\nc;3.456\nz;12,5\n", "are mixed"),
    ];
    for (standard, wanted) in mixed {
        desk.write("standard.csv", standard);
        let refused = desk.refused(&["method.csv", "standard.csv", "--column", "volume_mm3"]);
        assert!(refused.contains(wanted) && refused.contains("standard.csv: "), "{standard}: {refused}");
    }
    for (name, value) in [("a", "1.234"), ("b", "2,5"), ("c", "3,5")] {
        desk.write(&format!("each/{name}.csv"), &format!("volume_mm3;note\n{value};x\n"));
    }
    let refused = desk.refused(&["method.csv", "each"]);
    assert!(refused.contains("a.csv: line 2 has `1.234`") && refused.contains("b.csv: line 2"), "{refused}");
}

/// What has one sign throughout is read, and told of where even so nothing says what it stands for; words, dates
/// and lists in other columns are no numbers.
#[test]
fn one_decimal_sign_is_read() {
    let desk = Desk::new();
    desk.write("method.csv", METHOD);
    let plain = [
        ("input;volume_mm3\na;1,5\nb;12,25\nc;33,125\n", 22.0 - 46.875 / 3.0),
        ("input;volume_mm3\na;1.5\nb;12.25\nc;33.125\n", 22.0 - 46.875 / 3.0),
        (
            "input;volume_mm3;day\na;1,5;01.02.2024\nb;12,25;1.3.2024\nc;33,125;2.3.2024\n",
            22.0 - 46.875 / 3.0,
        ),
        (
            "input,volume_mm3,size\na,1.5,\"512,512,300\"\nb,12.25,\"512,512\"\nc,33.125,\"1,2\"\n",
            22.0 - 46.875 / 3.0,
        ),
        (
            "input;volume_mm3\na;1,5e1\nb;1.225e1\nc;33\n".replace("1.225e1", "1,225e1").leak(),
            22.0 - (15.0 + 12.25 + 33.0) / 3.0,
        ),
        ("input,volume_mm3\na,1.234\nb,2.345\nc,3.456\n", 22.0 - 7.035 / 3.0),
        ("input;volume_mm3;t\na;1.234;0.5\nb;2.345;1.5\nc;3.456;2\n", 22.0 - 7.035 / 3.0),
        ("input;volume_mm3\na;1,234\nb;2,345\nc;1234\n", 22.0 - 1237.579 / 3.0),
    ];
    for (standard, bias) in plain {
        desk.write("standard.csv", standard);
        let found = desk.bias(&["method.csv", "standard.csv"]);
        assert!((found - bias).abs() < 1e-9, "{standard}: {found}, not {bias}");
        let output = desk.compare(&["method.csv", "standard.csv"]);
        assert!(!text(&output.stdout).contains("thousands"), "{standard}");
    }
    desk.write("standard.csv", "input;volume_mm3\na;1.234\nb;2.345\nc;333\n");
    let document = desk.document(&["method.csv", "standard.csv"]);
    let doubt = document["doubts"][0].as_str().unwrap();
    assert!(
        doubt.starts_with("standard.csv: line 2 has `1.234` in column `volume_mm3`, read with a decimal")
    );
    assert!(text(&desk.compare(&["method.csv", "standard.csv"]).stdout).contains(doubt));
}

/// The file that is at fault is named, and what is at fault in it.
#[test]
fn the_table_at_fault_is_named() {
    let desk = Desk::new();
    desk.write("method.csv", METHOD);
    let faults = [
        ("input,volume_mm3,mass,volume_mm3\na,1,2,3\n", "more than one column is called `volume_mm3`"),
        ("input,volume_mm3, volume_mm3\na,1,2\n", "more than one column is called `volume_mm3`"),
        ("input,volume_mm3\n", "there are no objects in it, only the columns input, volume_mm3"),
        ("input,volume_mm3,error\na,1,broken\n", "; all 1 rows are of inputs that failed"),
        ("", "the file is empty"),
        ("\u{feff}\r\n \n# only a remark\n", "the file is empty"),
        ("input,volume_mm3\na,1\nb,2,3\n", "line 3 has 3 cells, but there are 2 columns; quote cells"),
        ("input,x,method,x@m\na,1,m,3\na,2,n,3\n", "more than one column is called `x@m`"),
    ];
    for (standard, wanted) in faults {
        desk.write("standard.csv", standard);
        for tables in [["method.csv", "standard.csv"], ["standard.csv", "method.csv"]] {
            let refused = desk.refused(&tables);
            let at_fault = refused.contains("surfometry: standard.csv: ");
            assert!(at_fault && refused.contains(wanted), "{standard}: {refused}");
        }
    }
    let missing = desk.refused(&["method.csv", "nowhere.csv"]);
    assert!(
        missing.contains("nowhere.csv: cannot be read: No such file")
            && missing.contains("a folder of tables")
    );
}

/// Lines that are no rows: what a spreadsheet writes first, remarks, cells without anything in them.
#[test]
fn lines_that_are_no_rows() {
    let desk = Desk::new();
    desk.write("method.csv", METHOD);
    let forms = [
        "sep=;\r\ninput;volume_mm3\r\na;1,0\r\nb;2,0\r\nc;3,0\r\n",
        "\u{feff}\"sep=;\"\ninput;volume_mm3;\na;1,0;\nb;2,0;\nc;3,0;\n;;\n",
        "SEP=|\ninput|volume_mm3\na|1\nb|2\nc|3\n",
        "sep=\t\ninput\tvolume_mm3\na\t1\nb\t2\nc\t3\n",
        "# made by hand; on a Monday\n#\n\ninput,volume_mm3\n# a, b\na,1\n#, x, y\nb,2\n\nc,3\n# end\n",
        "#,input,volume_mm3\n1,a,1\n2,b,2\n3,c,3\n",
    ];
    for form in forms {
        desk.write("standard.csv", form);
        assert!((desk.bias(&["method.csv", "standard.csv"]) - 20.0).abs() < 1e-12, "{form}");
    }
    // Objects that are called #1 are none.
    desk.write("numbered.csv", "input,volume_mm3\n#1,1\n#2,2\n#3,4\n");
    assert_eq!(desk.document(&["numbered.csv", "numbered.csv"])["matched"], 3);
}

/// A column's name with a colon, and a column of labels that is called otherwise.
#[test]
fn columns_are_found_by_their_names() {
    let desk = Desk::new();
    desk.write("method.csv", "input,Region,V: mm3\na,1,11\na,2,22\nb,1,33\n");
    desk.write("standard.csv", "Image: file,label,V: mm3,a:b\na,1,1,5\na,2,2,6\nb,1,4,7\n");
    let keys = ["method.csv", "standard.csv", "--object", "input:Image: file", "--label", "Region:label"];
    let bias = |column: &str| desk.bias(&[&keys[..], &["--column", column]].concat());
    assert!((bias("V: mm3") - 59.0 / 3.0).abs() < 1e-12);
    assert!((bias("V: mm3:a:b") - 16.0).abs() < 1e-12);
    let without = desk.refused(&[&keys[..4], &["--column", "V: mm3"]].concat());
    assert!(without.contains("method.csv: a is there more than once"), "{without}");
    let wrong =
        desk.refused(&["method.csv", "standard.csv", "--object", "input:Image: file", "--label", "Regio"]);
    assert!(wrong.contains("there is no column `Regio` of labels; its columns are input, Region"), "{wrong}");
    desk.write("both.csv", "input,x,y,x:y\na,1,2,3\nb,2,3,4\nc,3,4,6\n");
    let both = desk.refused(&["both.csv", "both.csv", "--column", "x:y"]);
    assert!(both.contains("`x:y` may be `x` against `y` or `x:y` against `x:y`"), "{both}");
}

/// A standard that is known exactly, as a phantom's volume, has a bias and limits, but neither slope nor
/// correlation. Differences 1, 2, 3 + 0.1: bias 2.1, standard deviation 1.
#[test]
fn a_constant_standard() {
    let desk = Desk::new();
    desk.write("method.csv", "input,volume_mm3\na,1.2\nb,2.2\nc,3.2\n");
    desk.write("standard.csv", "input,volume_mm3\na,0.1\nb,0.1\nc,0.1\n");
    let charts = ["-o", "chart.svg", "-o", "page.html"];
    let document = desk.document(&[&["method.csv", "standard.csv"][..], &charts].concat());
    let measure = &document["measures"][0];
    let agreement = &measure["agreement"];
    let number = |value: &Value| value.as_f64().unwrap();
    assert!((number(&agreement["bland_altman"]["bias"]["value"]) - 2.1).abs() < 1e-12);
    assert!((number(&agreement["bland_altman"]["limits"][1]["value"]) - 4.06).abs() < 1e-12);
    // t = 2.1 sqrt 3 = 3.637 with 2 degrees of freedom.
    assert!((number(&agreement["bland_altman"]["bias_p_value"]) - 0.0680).abs() < 5e-4);
    for none in [
        &agreement["regression"]["slope"]["value"],
        &agreement["regression"]["slope_p_value"],
        &agreement["concordance"]["value"],
        &agreement["intraclass"]["agreement"]["value"],
        &agreement["bland_altman"]["proportional"]["slope"]["value"],
    ] {
        assert!(none.is_null(), "{agreement}");
    }
    assert!(measure["problem"].as_str().unwrap().contains("neither slope nor correlation"));
    for file in ["chart.svg", "page.html"] {
        let written = std::fs::read_to_string(desk.path(file)).unwrap();
        assert!(!written.contains("NaN"), "{file}");
    }
    let shown = desk.compare(&["method.csv", "standard.csv"]);
    assert!(
        text(&shown.stdout).contains("bias                 2.1 (") && !text(&shown.stdout).contains("NaN")
    );
}

/// What follows a point may tell objects apart. Only endings of files are cut off, and that is told; the bias says who
/// went with whom.
#[test]
fn names_that_have_points_in_them() {
    let desk = Desk::new();
    let table = |name: &str, inputs: &[&str], first: i32| {
        let rows: Vec<String> =
            inputs.iter().zip(first..).map(|(input, n)| format!("{input},{n}\n")).collect();
        desk.write(name, &format!("input,volume_mm3\n{}", rows.concat()));
    };
    let pair = |method: &[&str], standard: &[&str]| {
        table("method.csv", method, 11);
        table("standard.csv", standard, 1);
    };
    for (method, standard) in [
        (["S01.left", "S02.left", "S03.left"], ["S01.right", "S02.right", "S03.right"]),
        (["p1.5mm", "p2.5mm", "p3.5mm"], ["p1.7mm", "p2.7mm", "p3.7mm"]),
        (["a.v1.nii", "b.v1.nii", "c.v1.nii"], ["a.v2.nii", "b.v2.nii", "c.v2.nii"]),
    ] {
        pair(&method, &standard);
        let refused = desk.refused(&["method.csv", "standard.csv"]);
        assert!(refused.contains("no object is in both") && refused.contains(standard[0]), "{refused}");
    }
    for (method, standard) in [
        (["p1.5mm.nii.gz", "p2.5mm.nii.gz", "p3.5mm.nii.gz"], ["p1.5mm", "p2.5mm", "p3.5mm"]),
        (["sub-1.5mm.nii.gz", "sub-1.7mm.nii.gz", "sub-1.mha"], ["sub-1.5mm", "sub-1.7mm", "x/sub-1"]),
    ] {
        pair(&method, &standard);
        assert!((desk.bias(&["method.csv", "standard.csv"]) - 10.0).abs() < 1e-12);
        let document = desk.document(&["method.csv", "standard.csv"]);
        let doubt = document["doubts"][0].as_str().unwrap();
        let wanted = format!("only without their endings, as `{}` and `{}`", method[0], standard[0]);
        assert!(doubt.contains(&wanted), "{doubt}");
        assert!(text(&desk.compare(&["method.csv", "standard.csv"]).stdout).contains(doubt));
    }
    // Folders alone leave no doubt.
    pair(&["x/a.nii", "x/b.nii", "x/c.nii"], &["y/a.nii", "y/b.nii", "y/c.nii"]);
    assert_eq!(desk.document(&["method.csv", "standard.csv"])["doubts"].as_array().unwrap().len(), 0);
}

/// A column that is compared by default is passed over only where it has no value at all, never because it cannot be
/// read.
#[test]
fn unreadable_columns_are_not_passed_over() {
    let desk = Desk::new();
    let area = "surface_area_mm2";
    desk.write("method.csv", "input,volume_mm3,surface_area_mm2\na,11,1\nb,22,2\nc,33,4\n");
    let table = |volumes: [&str; 3]| {
        let [a, b, c] = volumes;
        desk.write("standard.csv", &format!("input,volume_mm3,{area}\na,{a},1\nb,{b},2\nc,{c},4\n"));
        desk.write("alone.csv", &format!("input,volume_mm3\na,{a}\nb,{b}\nc,{c}\n"));
    };
    for (volumes, wanted) in [
        (
            ["\"1,000.5\"", "\"2,000.5\"", "\"3,000.5\""],
            "in column `volume_mm3`, with a sign between thousands",
        ),
        (["10 mm3", "20 mm3", "30 mm3"], "has `10 mm3` in column `volume_mm3`, which is no number"),
        (["inf", "2", "3"], "a has `inf` in column `volume_mm3`, which is no number"),
        (["1", "-1e999", "3"], "b has `-1e999` in column `volume_mm3`, which is no number"),
    ] {
        table(volumes);
        for standard in ["standard.csv", "alone.csv"] {
            let refused = desk.refused(&["method.csv", standard]);
            assert!(refused.contains(wanted) && refused.contains(standard), "{refused}");
        }
    }
    table(["NA", "", "-"]);
    let document = desk.document(&["method.csv", "standard.csv"]);
    let columns: Vec<&Value> =
        document["measures"].as_array().unwrap().iter().map(|measure| &measure["column"]).collect();
    assert_eq!(columns, [area]);
    let refused = desk.refused(&["method.csv", "alone.csv"]);
    assert!(refused.contains("or only such as have no value in one of them"), "{refused}");
}

/// A line that is no record is named by its number in the file, and united labels are one object in whatever order.
#[test]
fn records_a_line_each() {
    let desk = Desk::new();
    desk.write("method.csv", "input,label,volume_mm3\na,1+2,11\na,3,22\na,10+9,33\n");
    let record = |label: &str, volume: &str| {
        format!("{{\"input\": \"a\", \"label\": {label}, \"volume_mm3\": {volume}}}\n")
    };
    let good = record("\"2+1\"", "1") + "\n" + &record("3", "2") + &record("\"9+10\"", "3");
    desk.write("standard.jsonl", &good);
    assert!((desk.bias(&["method.csv", "standard.jsonl"]) - 20.0).abs() < 1e-12);
    assert_eq!(desk.document(&["method.csv", "standard.jsonl"])["matched"], 3);
    desk.write("standard.jsonl", &(good + &record("4", "NaN")));
    let refused = desk.refused(&["method.csv", "standard.jsonl"]);
    assert!(
        refused.contains("standard.jsonl: not a document of results: line 5, column 42: expected value"),
        "{refused}"
    );
    assert!(!refused.contains("line 1"), "{refused}");
}

/// Where one of several files cannot be made, none is written.
#[test]
fn files_are_written_together() {
    let desk = Desk::new();
    desk.write("method.csv", "input,volume_mm3\na,1\nb,2\n");
    let refused = desk.refused(&["method.csv", "method.csv", "-o", "page.html", "-o", "chart.png"]);
    assert!(
        refused.contains("chart.png: there is no chart to draw: volume_mm3: 2 pairs are too few"),
        "{refused}"
    );
    assert!(!desk.path("page.html").exists() && !desk.path("chart.png").exists());
    assert_eq!(desk.document(&["method.csv", "method.csv"])["matched"], 2);
}

/// One file name in each subject's folder, as FreeSurfer has it, may pair other subjects: that is told, where both tables
/// have folders, with the names; not where one has none, or they are the same.
#[test]
fn names_in_other_folders_are_told_of() {
    let desk = Desk::new();
    let table = |name: &str, folder: &str| {
        let rows: Vec<String> =
            (1..4).map(|label| format!("{folder}seg.nii.gz,{label},{label}5\n")).collect();
        desk.write(name, &format!("input,label,volume_mm3\n{}", rows.concat()));
    };
    for (folders, is_told) in
        [(["/d/S01/", "/m/S02/"], true), (["/d/S01/", ""], false), (["d/", "d/"], false)]
    {
        table("method.csv", folders[0]);
        table("standard.csv", folders[1]);
        let doubts = desk.document(&["method.csv", "standard.csv"])["doubts"].to_string();
        let wanted = "only without their folders, as `/d/S01/seg.nii.gz` and `/m/S02/seg.nii.gz`";
        assert_eq!(doubts.contains(wanted), is_told, "{doubts}");
        assert_eq!(doubts == "[]", !is_told, "{doubts}");
    }
}

/// A column `error` of numbers is a standard error of another program; one of words tells which inputs failed, and how many
/// those are is said.
#[test]
fn failures_are_words_and_counted() {
    let desk = Desk::new();
    let table = |name: &str, errors: [&str; 4]| {
        let rows: Vec<String> =
            errors.iter().zip(1..).map(|(error, n)| format!("s{n},{n}5,{error}\n")).collect();
        desk.write(name, &format!("input,volume_mm3,error\n{}", rows.concat()));
    };
    table("numbers.csv", ["0.1", "2e-3", "", "4"]);
    table("words.csv", ["", "cannot be read", "", "no object"]);
    let counts = |tables: [&str; 2]| {
        let document = desk.document(&tables);
        [&document["matched"], &document["method_rows"]["failed"], &document["standard_rows"]["failed"]]
            .map(|count| count.as_u64().unwrap())
    };
    assert_eq!(counts(["numbers.csv", "numbers.csv"]), [4, 0, 0]);
    assert_eq!(counts(["numbers.csv", "words.csv"]), [2, 0, 2]);
    let compared = desk.compare(&["words.csv", "words.csv"]);
    let said = text(&compared.stdout);
    assert_eq!(said.matches("2 rows more are of inputs that failed").count(), 2, "{said}");
}

/// Subjects in folders of one file name each, under a folder that is another one in each table: that one is left out, the
/// subjects' folders stay, and what they are compared by is said nowhere as a doubt that is none.
#[test]
fn folders_tell_subjects_apart() {
    let table = |name: &dyn Fn(u32) -> String, add: f64| -> String {
        let row = |n: u32| format!("{},1,{}\n", name(n), f64::from(n) * 10.0 + add);
        "input,label,volume_mm3\n".to_owned() + &(1..=4).map(row).collect::<String>()
    };
    let desk = Desk::new();
    desk.write("standard.csv", &table(&|n| format!("manual/sub-0{n}/seg.nii.gz"), 0.0));
    let names: [&dyn Fn(u32) -> String; 4] = [
        &|n| format!("auto/sub-0{n}/seg.nii.gz"),
        &|n| format!("/data/net 2/sub-0{n}/out/seg.nii.gz"),
        &|n| format!("auto/sub-0{n}/seg.mha"),
        &|n| format!("sub-0{n}/seg.nii.gz"),
    ];
    for name in names {
        desk.write("method.csv", &table(name, 2.5));
        let document = desk.document(&["method.csv", "standard.csv", "--column", "volume_mm3"]);
        let agreement = &document["measures"][0]["agreement"];
        assert_eq!(agreement["count"], 4, "{agreement}");
        let bias = agreement["bland_altman"]["bias"]["value"].as_f64().unwrap();
        assert!((bias - 2.5).abs() < 1e-12, "{}: {bias}", name(1));
        assert!(!document.to_string().contains("without their folders"), "{document}");
    }
    // A subject of one table alone stays its own.
    desk.write(
        "method.csv",
        &(table(names[0], 2.5) + "auto/sub-09/seg.nii.gz,1,90\nauto/sub-08/seg.nii.gz,1,80\n"),
    );
    let document = desk.document(&["method.csv", "standard.csv", "--column", "volume_mm3"]);
    assert_eq!(document["only_method"].as_array().map(Vec::len), Some(2), "{document}");
    // The same row twice is refused still.
    desk.write("method.csv", &(table(names[0], 2.5) + "auto/sub-01/seg.nii.gz,1,90\n"));
    assert!(desk.refused(&["method.csv", "standard.csv"]).contains("more than once"));
}
