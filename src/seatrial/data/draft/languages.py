"""Headings of logs in other languages of seafarers, as the English names that a draft knows.

Danish, Dutch, French, German, Italian, Norwegian, Portuguese, Spanish and Swedish, as bridge displays and trial reports
have them; in small letters, accents off, words joined by underscores.
"""

import re
import unicodedata

_HEADINGS = {
    "time": "tid tidspunkt klokke klokken klokkeslett klokkeslet klockslag zeit uhrzeit zeitstempel tijd tijdstip "
            "heure temps horodatage hora tiempo ora orario tempo",
    "date": "dato datum fecha data",
    "latitude": "bredde breddegrad latitud breite breitengrad breedte breedtegraad latitudine",
    "longitude": "lengde lengdegrad laengde laengdegrad langd longitud laenge lange langengrad laengengrad lengte "
                 "lengtegraad longitudine",
    "speed_over_ground": "fart_over_grunn fart_over_bunn hastighet_over_grunn fart_over_grund hastighed_over_grund "
                         "fahrt_uber_grund fahrt_ueber_grund geschwindigkeit_uber_grund geschwindigkeit_ueber_grund "
                         "fug grondsnelheid snelheid_over_de_grond vitesse_fond vitesse_sur_le_fond "
                         "velocidad_sobre_el_fondo velocidad_sobre_fondo velocita_sul_fondo velocidade_sobre_o_fundo",
    "course_over_ground": "kurs_over_grunn kurs_over_grund kurs_uber_grund kurs_ueber_grund kug grondkoers "
                          "koers_over_de_grond route_fond route_sur_le_fond rumbo_sobre_el_fondo rumbo_sobre_fondo "
                          "rotta_sul_fondo rumo_sobre_o_fundo",
    "speed_through_water": "fart_gjennom_vann fart_gjennom_vannet fart_gennem_vand fart_genom_vattnet "
                           "fart_genom_vatten fahrt_durchs_wasser fahrt_durch_das_wasser fdw "
                           "snelheid_door_het_water vitesse_surface velocidad_respecto_al_agua",
    "heading": "kurs stevning styrekurs gyrokurs steuerkurs vorausrichtung koers cap cap_vrai rumbo rumbo_verdadero "
               "proa prua prora aproamento",
    "compass": "kompass kompasskurs kompas kompaskurs kompaskoers cap_compas",
    "rate_of_turn": "svinghastighet girrate girehastighet drejehastighed svanghastighet girhastighet drehrate "
                    "drehgeschwindigkeit wendegeschwindigkeit gierrate giergeschwindigkeit draaisnelheid "
                    "vitesse_de_giration taux_de_giration vitesse_de_lacet velocidad_de_giro velocidad_de_guinada "
                    "velocita_di_accostata velocita_di_imbardata taxa_de_guinada",
    "rudder_angle": "ror rorvinkel roder rodervinkel roderlage rorlage ruder ruderwinkel ruderlage roer roerhoek "
                    "roerstand barre angle_de_barre safran timon angulo_de_timon angulo_del_timon timone "
                    "angolo_timone angolo_di_barra leme angulo_do_leme",
    "shaft_rpm": "turtall omdreininger propellerturtall varvtal propellervarvtal omdrejningstal omdrejninger drehzahl "
                 "wellendrehzahl propellerdrehzahl toerental omwentelingen tours_minute regime_helice "
                 "regime_ligne_d_arbre revoluciones giri giri_elica numero_di_giri rotacoes",
    "engine_speed": "maskinturtall motorturtall motorvarvtal motordrehzahl motortoerental regime_moteur "
                    "revoluciones_del_motor giri_motore",
    "roll": "rull rulling rullevinkel krengning krangning rullning kraengning rulning krengningsvinkel slagside "
            "rollwinkel krangung rolhoek helling roulis gite balanceo escora rollio sbandamento balanco",
    "roll_rate": "rullhastighet rullehastighet rollrate rollgeschwindigkeit rolsnelheid vitesse_de_roulis",
    "pitch": "stamping stampvinkel nickwinkel stampfwinkel stampning stamphoek tangage cabeceo beccheggio "
             "arfagem",
    "heave": "hiv hivning havning tauchbewegung dompen pilonnement sussulto",
}  # fmt: skip
_ENGLISH = {word: english for english, words in _HEADINGS.items() for word in words.split()}
# letters that do not come apart into a letter and its accent
_LETTERS = str.maketrans({"ø": "o", "æ": "ae", "ß": "ss", "œ": "oe", "ł": "l", "đ": "d"})


def without_accents(text: str) -> str:
    """Return a text in small letters, without accents."""
    apart = unicodedata.normalize("NFKD", text.lower().translate(_LETTERS))
    return "".join(letter for letter in apart if not unicodedata.combining(letter))


def plain_name(name: str) -> str:
    """Return a heading in small letters and figures without accents, with a line between words."""
    return re.sub(r"[^a-z0-9]+", "_", without_accents(name)).strip("_")


def in_english(plain: str) -> str:
    """Return the English heading of a plain one in another language; as it is where it is not known.

    plain: small letters without accents, words joined by underscores.
    """
    return _ENGLISH.get(plain, plain)
