//! Enums whose variants have a name on the command line, in files, in JSON or on a button, and other texts.
//!
//! A variant is written once, with its texts; the rest follows from that.

/// Defines an enum with `ALL` in the order given, `name`, `from_name`, and serde by name. Functions that are named in
/// brackets after the enum's own name return the texts in brackets after the variants' names, in the same order.
macro_rules! named_enum {
    (@texts $Enum:ident [] $([$Variant:ident])+) => {};
    (
        @texts $Enum:ident [$(#[$of_text:meta])* $text_of:ident $(, $($other_texts_of:tt)+)?]
        $([$Variant:ident $text:expr $(, $($other_texts:tt)+)?])+
    ) => {
        impl $Enum {
            $(#[$of_text])*
            pub const fn $text_of(self) -> &'static str {
                match self {
                    $($Enum::$Variant => $text,)+
                }
            }
        }

        named_enum!(@texts $Enum [$($($other_texts_of)+)?] $([$Variant $($($other_texts)+)?])+);
    };
    (
        $(#[$attribute:meta])*
        pub enum $Enum:ident $(($($texts_of:tt)+))? {
            $($(#[$of_variant:meta])* $Variant:ident = $name:literal $(($($texts:tt)+))?,)+
        }
    ) => {
        $(#[$attribute])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum $Enum {
            $($(#[$of_variant])* $Variant,)+
        }

        impl $Enum {
            /// All variants, in order.
            pub const ALL: [$Enum; [$($name),+].len()] = [$($Enum::$Variant),+];

            /// Returns its name on the command line, in files and in JSON, or on its button.
            pub const fn name(self) -> &'static str {
                match self {
                    $($Enum::$Variant => $name,)+
                }
            }

            /// Returns the variant with exactly this name (case matters); `None` where there is none.
            pub fn from_name(name: &str) -> Option<$Enum> {
                $Enum::ALL.into_iter().find(|one| one.name() == name)
            }
        }

        impl serde::Serialize for $Enum {
            fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.serialize_str(self.name())
            }
        }

        impl<'de> serde::Deserialize<'de> for $Enum {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<$Enum, D::Error> {
                let name = <std::borrow::Cow<'de, str> as serde::Deserialize>::deserialize(deserializer)?;
                $Enum::from_name(&name).ok_or_else(|| serde::de::Error::custom(format!("nothing is called `{name}` here")))
            }
        }

        named_enum!(@texts $Enum [$($($texts_of)+)?] $([$Variant $($($texts)+)?])+);
    };
}
